#include "core/sampling/output/attributes.h"

#include <gtest/gtest.h>

#include "core/mesh/attributes.h"
#include "core/sampling/sampling.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

TEST(InterpolateAttributes, IsLinearOverTheHostByVertexAndByCorner) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  mesh.attributes = {{.name = "color",
                      .kind = AttributeKind::kColor,
                      .components = 3,
                      .values = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}},
                     {.name = "step", .per_corner = true, .values = {0, 8, 16, 100, 200, 300}}};
  SampleSet samples;
  samples.faces = {0, 1, 1};
  samples.barycentrics = {{0.5, 0.25}, {0.5, 0.25}, {0, 0}};
  const std::vector<Attribute> values = InterpolateAttributes(mesh, samples);
  ASSERT_EQ(values.size(), 2u);
  EXPECT_EQ(values[0].name, "color");
  EXPECT_EQ(values[0].kind, AttributeKind::kColor);
  EXPECT_EQ(values[0].values,
            (std::vector<float>{0.5F, 0.25F, 0.25F, 0.75F, 0.25F, 0.5F, 1, 1, 1}));
  EXPECT_FALSE(values[1].per_corner);
  EXPECT_EQ(values[1].values, (std::vector<float>{6, 175, 300}));
}

// A linear function of the position is interpolated to the function of the sample's position.
TEST(InterpolateAttributes, SampledMeshesCarryThem) {
  TriangleMesh mesh = shapes::Icosphere(3);
  Attribute height{.name = "height", .components = 2};
  for (const Eigen::Vector3d& p : mesh.positions) {
    height.values.push_back(static_cast<float>(p.z()));
    height.values.push_back(static_cast<float>(2 * p.x() - p.y()));
  }
  mesh.attributes = {height};
  SamplingOptions options;
  options.sample_count = 200;
  options.max_iterations = 2;
  const auto result = SampleSurface(mesh, options);
  ASSERT_TRUE(result.ok()) << result.status();
  ASSERT_EQ(result->samples.attributes.size(), 1u);
  const Attribute& sampled = result->samples.attributes[0];
  ASSERT_EQ(sampled.values.size(), 400u);
  for (std::size_t i = 0; i < 200; ++i) {
    const Eigen::Vector3d& p = result->samples.positions[i];
    EXPECT_NEAR(sampled.values[2 * i], p.z(), 1e-6);
    EXPECT_NEAR(sampled.values[2 * i + 1], 2 * p.x() - p.y(), 1e-6);
  }
}

TEST(InterpolateAttributes, WrongSizesAreRefusedBeforeAnythingIsComputed) {
  TriangleMesh mesh = shapes::Icosphere(1);
  mesh.attributes = {{.name = "heat", .values = {1, 2, 3}}};
  SamplingOptions options;
  options.sample_count = 50;
  const auto result = SampleSurface(mesh, options);
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(result.status().message().find("'heat'"), std::string::npos);
}

TEST(CheckAttributes, KnowsTheSizes) {
  TriangleMesh mesh = shapes::SingleTriangle();
  mesh.attributes = {{.name = "a", .components = 2, .values = std::vector<float>(6)},
                     {.name = "b", .per_corner = true, .values = std::vector<float>(3)}};
  EXPECT_TRUE(CheckAttributes(mesh).ok());
  for (const int components : {0, 1, 3, 5, -2}) {
    mesh.attributes[0].components = components;
    EXPECT_FALSE(CheckAttributes(mesh).ok()) << components;
  }
}

}  // namespace
}  // namespace ccst::internal
