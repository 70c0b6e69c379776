#include "server/rpc/mesh_messages.h"

#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

TEST(MeshMessages, FactsComeBackAsTheyWereWrittenDown) {
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

TEST(MeshMessages, MeshSaysEverything) {
  StoredMesh mesh;
  mesh.record = SomeMesh("ann", "mesh");
  mesh.facts.warnings = {"one"};
  mesh.facts.attributes.push_back({.name = "heat"});
  const v1::Mesh message = ToProto(mesh);
  // Counts and values may be zero, as here.
  for (const char* field : {"name", "digest", "display_name", "create_time", "expire_time",
                            "bounds_min", "bounds_max"}) {
    const auto* descriptor = v1::Mesh::descriptor()->FindFieldByName(field);
    EXPECT_TRUE(message.GetReflection()->HasField(message, descriptor)) << field;
  }
  EXPECT_EQ(message.attributes_size(), 1);
  EXPECT_EQ(message.warnings_size(), 1);
}

TEST(MeshMessages, DamagedFactsAreAFaultOfTheStorage) {
  ExpectError(DecodeFacts("\xff\xff\xff").status(), absl::StatusCode::kDataLoss, "STORAGE_FAILED");
}

TEST(MeshMessages, PageSizeHasADefaultAndALimit) {
  Violations violations;
  EXPECT_EQ(PageSize(0, violations), 50);
  EXPECT_EQ(PageSize(7, violations), 7);
  EXPECT_EQ(PageSize(5000, violations), 1000);
  EXPECT_TRUE(violations.ToStatus().ok());
  PageSize(-1, violations);
  EXPECT_FALSE(violations.ToStatus().ok());
}

}  // namespace
}  // namespace ccst::server
