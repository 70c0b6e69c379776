#include "server/formats/mesh_facts.h"

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

TEST(StoredMeshFacts, ComeBackAsTheyWereWrittenDown) {
  const MeshFacts facts{
      .vertices = 1,
      .file_faces = 2,
      .components = 3,
      .boundary_loops = 4,
      .area = 5.5,
      .bounds_min = {1e-300, -1.0 / 3.0, 0.0},
      .bounds_max = {1.0, 2.0, 3.0},
      .attributes = {{.name = "heat", .components = 2, .min_value = -1.5, .max_value = 7.25}},
      .warnings = {"one", "two"}};
  const MeshFacts back = *DecodeFacts(EncodeFacts(facts));
  EXPECT_EQ(back.vertices, 1);
  EXPECT_EQ(back.file_faces, 2);
  EXPECT_EQ(back.components, 3);
  EXPECT_EQ(back.boundary_loops, 4);
  EXPECT_EQ(back.area, 5.5);
  EXPECT_EQ(back.bounds_min, facts.bounds_min);
  EXPECT_EQ(back.bounds_max, facts.bounds_max);
  ASSERT_EQ(back.attributes.size(), 1u);
  EXPECT_EQ(back.attributes[0].name, "heat");
  EXPECT_EQ(back.attributes[0].components, 2);
  EXPECT_EQ(back.attributes[0].min_value, -1.5);
  EXPECT_EQ(back.attributes[0].max_value, 7.25);
  EXPECT_EQ(back.warnings, facts.warnings);
}

TEST(StoredMeshFacts, DamageIsNoticed) {
  for (const char* bytes : {"", "x", "\xff\xff\xff"}) {
    const auto read = DecodeFacts(bytes);
    EXPECT_EQ(read.status().code(), absl::StatusCode::kDataLoss);
    EXPECT_EQ(GetErrorReason(read.status()), ErrorReason::kStorageFailed);
  }
}

}  // namespace
}  // namespace ccst::server
