#include "tests/core/methods/methods_test_util.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst::methods_test {

const std::vector<Method>& AllMethods() {
  static const auto* methods = new std::vector<Method>{
      {"white noise", DrawWhiteNoise},
      {"dart throwing",
       [](const Surface& surface, const Density& density, std::int64_t count, std::uint64_t seed,
          const MethodControl& control) -> absl::StatusOr<Points> {
         absl::StatusOr<DartSamples> samples = ThrowDarts(surface, density, count, seed, control);
         if (!samples.ok()) return samples.status();
         return samples->points;
       }},
      {"elimination", EliminateSamples},
      {"lloyd",
       [](const Surface& surface, const Density& density, std::int64_t count, std::uint64_t seed,
          const MethodControl& control) -> absl::StatusOr<Points> {
         absl::StatusOr<RelaxedSamples> samples =
             RelaxLloyd(surface, density, count, seed, {.max_steps = 30}, control);
         if (!samples.ok()) return samples.status();
         return samples->points;
       }},
      {"balanced voronoi",
       [](const Surface& surface, const Density& density, std::int64_t count, std::uint64_t seed,
          const MethodControl& control) -> absl::StatusOr<Points> {
         absl::StatusOr<RelaxedSamples> samples = BalanceVoronoi(
             surface, density, count, seed, {.max_steps = 100, .points_per_sample = 32}, control);
         if (!samples.ok()) return samples.status();
         return samples->points;
       }},
  };
  return *methods;
}

Points Sample(const std::string& name, const Surface& surface, const Density& density,
              std::int64_t count, std::uint64_t seed) {
  Interrupt never;
  for (const Method& method : AllMethods()) {
    if (method.name != name) continue;
    absl::StatusOr<Points> points = method.run(surface, density, count, seed, {&never});
    EXPECT_TRUE(points.ok()) << name << ": " << points.status();
    return points.ok() ? *points : Points();
  }
  ADD_FAILURE() << "no method is called " << name;
  return {};
}

Surface SurfaceOf(const TriangleMesh& mesh) {
  absl::StatusOr<Surface> surface = Surface::Build(mesh);
  EXPECT_TRUE(surface.ok()) << surface.status();
  return *std::move(surface);
}

Density DensityOf(const Surface& surface,
                  const std::function<double(const Eigen::Vector3d&)>& rho) {
  std::vector<double> corners;
  for (const Eigen::Vector3i& face : surface.faces()) {
    for (const std::int32_t v : face)
      corners.push_back(rho(surface.ToMesh(surface.positions()[v])));
  }
  absl::StatusOr<Density> density = Density::Linear(surface, std::move(corners), 1e6);
  EXPECT_TRUE(density.ok()) << density.status();
  return *std::move(density);
}

std::vector<Eigen::Vector3d> HostNormals(const Surface& surface, const Points& points) {
  std::vector<Eigen::Vector3d> normals;
  for (const SurfacePoint& point : points) {
    const Eigen::Vector3i& face = surface.faces()[point.face];
    const Eigen::Vector3d& a = surface.positions()[face[0]];
    normals.push_back(
        (surface.positions()[face[1]] - a).cross(surface.positions()[face[2]] - a).normalized());
  }
  return normals;
}

std::vector<Eigen::Vector3d> Positions(const Points& points) {
  std::vector<Eigen::Vector3d> positions;
  for (const SurfacePoint& point : points) positions.push_back(point.position);
  return positions;
}

quality::DistanceFigures Figures(const Surface& surface, const Points& points) {
  return quality::MeasureDistances(Positions(points), HostNormals(surface, points), surface.area());
}

TriangleMesh ThinPlate(double thickness) {
  TriangleMesh mesh = shapes::Cube();
  for (int level = 0; level < 3; ++level) mesh = shapes::Subdivided(mesh);
  for (Eigen::Vector3d& p : mesh.positions) p[2] = 0.5 * thickness * (p[2] + 1.0);
  return mesh;
}

}  // namespace ccst::methods_test
