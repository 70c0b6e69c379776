#include "server/rpc/mesh_messages.h"

#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

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
