#include "core/io/samples_digest.h"

#include <gtest/gtest.h>

namespace ccst {
namespace {

// Digests computed with Python's struct and hashlib from the layout in proto/docs/samples.md.

TEST(SamplesDigest, TheDocumentedExample) {
  SampleSet samples;
  samples.faces = {7, 0};
  samples.barycentrics = {{0.25, 0.5}, {1, 0}};
  EXPECT_EQ(SamplesDigest(samples),
            "83e6ac87bd3902c162e2a3ae81e1503f4f07f48fd46c2c9e94fbddbc883db8d5");
}

SampleSet TwoTriangles() {
  SampleSet samples;
  samples.faces = {0, 1, -1};
  samples.barycentrics = {{0.1, 0.2}, {0.3, 0.4}, {-0.0, 1e-300}};
  samples.triangles = {{0, 1, 2}, {2, 1, 0}};
  return samples;
}

TEST(SamplesDigest, TrianglesCount) {
  EXPECT_EQ(SamplesDigest(TwoTriangles()),
            "87f65deb17e43cd3fe40edc651402515d2de08fa033d1643e87455c4c3b43b78");
}

TEST(SamplesDigest, EveryBitCountsAndPositionsDoNot) {
  const std::string digest = SamplesDigest(TwoTriangles());
  SampleSet changed = TwoTriangles();
  changed.positions = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  changed.normals = changed.positions;
  EXPECT_EQ(SamplesDigest(changed), digest);
  changed = TwoTriangles();
  changed.barycentrics[2].x() = 0.0;
  EXPECT_NE(SamplesDigest(changed), digest);
  changed = TwoTriangles();
  std::swap(changed.triangles[0], changed.triangles[1]);
  EXPECT_NE(SamplesDigest(changed), digest);
  changed = TwoTriangles();
  changed.faces[0] = 2;
  EXPECT_NE(SamplesDigest(changed), digest);
}

TEST(SamplesDigest, LongSetsAreHashedInPieces) {
  SampleSet samples;
  samples.faces.assign(100000, 5);
  samples.barycentrics.assign(100000, {0.5, 0.25});
  samples.triangles.assign(200000, {1, 2, 3});
  EXPECT_EQ(SamplesDigest(samples),
            "fc61a9a890a50364a580bed468a58c9d37a032605ab330d6c3bb64e6770aaef9");
}

}  // namespace
}  // namespace ccst
