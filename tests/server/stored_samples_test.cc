#include "server/jobs/stored_samples.h"

#include <algorithm>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

class MemoryBlob : public BlobWriter, public Blob {
 public:
  absl::Status Append(std::string_view bytes) override {
    bytes_ += bytes;
    return absl::OkStatus();
  }
  std::int64_t size_bytes() const override { return static_cast<std::int64_t>(bytes_.size()); }
  const std::string& Seal() override { return bytes_; }
  absl::Status Commit() override { return absl::OkStatus(); }
  absl::Status Read(std::int64_t offset, std::span<char> out) const override {
    EXPECT_LE(offset + static_cast<std::int64_t>(out.size()), size_bytes());
    std::copy_n(bytes_.begin() + offset, out.size(), out.begin());
    return absl::OkStatus();
  }

  std::string bytes_;
};

SampleSet Samples() {
  SampleSet samples = MakeResult(100).samples;
  samples.attributes = {
      {.name = "mass", .components = 1, .values = {}},
      {.name = "color", .kind = AttributeKind::kColor, .components = 3, .values = {}}};
  for (int i = 0; i < 100; ++i) {
    samples.barycentrics[i] = Eigen::Vector2d(1.0 / (i + 3), 1.0 / 3.0);
    samples.positions[i] = Eigen::Vector3d(0.1 * i, -1e7, 1e-30);
    samples.attributes[0].values.push_back(0.5F * static_cast<float>(i));
    for (int k = 0; k < 3; ++k) samples.attributes[1].values.push_back(static_cast<float>(i + k));
  }
  return samples;
}

TEST(StoredSamples, AnyRangeReadsBackAsItWasWritten) {
  const SampleSet samples = Samples();
  const auto blob = std::make_shared<MemoryBlob>();
  ASSERT_TRUE(WriteSamples(samples, *blob).ok());
  const auto stored = StoredSamples::Open(blob);
  ASSERT_TRUE(stored.ok()) << stored.status();
  EXPECT_EQ(stored->sample_count(), 100);
  EXPECT_EQ(stored->triangle_count(), 100);
  for (const auto& [start, count] : {std::pair(0, 100), std::pair(17, 40), std::pair(100, 0)}) {
    const SampleSet read = *stored->ReadSamples(start, count);
    ASSERT_EQ(static_cast<int>(read.faces.size()), count);
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(read.faces[i], samples.faces[start + i]);
      EXPECT_EQ(read.barycentrics[i], samples.barycentrics[start + i]);
      EXPECT_EQ(read.positions[i], samples.positions[start + i].cast<float>().cast<double>());
      EXPECT_EQ(read.attributes[0].values[i], samples.attributes[0].values[start + i]);
      EXPECT_EQ(read.attributes[1].values[3 * i + 2],
                samples.attributes[1].values[3 * (start + i) + 2]);
    }
    const SampleSet mesh = *stored->ReadTriangles(start, count);
    for (int i = 0; i < count; ++i) EXPECT_EQ(mesh.triangles[i], samples.triangles[start + i]);
  }
  EXPECT_EQ(stored->attributes()[1].kind, AttributeKind::kColor);
}

TEST(StoredSamples, EveryTruncationIsNoticed) {
  MemoryBlob whole;
  ASSERT_TRUE(WriteSamples(Samples(), whole).ok());
  for (std::size_t size = 0; size < whole.bytes_.size(); size += 13) {
    const auto cut = std::make_shared<MemoryBlob>();
    cut->bytes_ = whole.bytes_.substr(0, size);
    EXPECT_EQ(GetErrorReason(StoredSamples::Open(cut).status()), ErrorReason::kStorageFailed);
  }
}

}  // namespace
}  // namespace ccst::server
