#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <stop_token>

#include <gtest/gtest.h>

#include "absl/status/status.h"
#include "tests/core/methods/methods_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using methods_test::AllMethods;
using methods_test::DensityOf;
using methods_test::Method;
using methods_test::Points;
using methods_test::Sample;
using methods_test::SurfaceOf;

bool SameBits(const Points& a, const Points& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].face != b[i].face || a[i].weights != b[i].weights || a[i].position != b[i].position) {
      return false;
    }
  }
  return true;
}

void ExpectOnSurface(const Surface& surface, const Points& points) {
  for (const SurfacePoint& point : points) {
    ASSERT_GE(point.face, 0);
    ASSERT_LT(point.face, surface.face_count());
    ASSERT_GE(point.weights.minCoeff(), 0.0);
    ASSERT_NEAR(point.weights.sum(), 1.0, 1e-12);
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      position += point.weights[k] * surface.positions()[surface.faces()[point.face][k]];
    }
    ASSERT_LE((position - point.position).norm(), 1e-12);
  }
}

TEST(AllMethods, GiveExactlyTheCountOnTheSurface) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 40, 20));
  const Density uniform = Density::Uniform(torus);
  const Density steep = DensityOf(torus, [](const auto& p) { return std::exp(3.0 * p.x()); });
  for (const Method& method : AllMethods()) {
    SCOPED_TRACE(method.name);
    for (const std::int64_t count : {4, 5, 300}) {
      for (const Density* density : {&uniform, &steep}) {
        const Points points = Sample(method.name, torus, *density, count);
        EXPECT_EQ(points.size(), static_cast<std::size_t>(count));
        ExpectOnSurface(torus, points);
      }
    }
  }
}

TEST(AllMethods, TakeWhatIsHardToSample) {
  // Fewer samples than components, a closed surface of four faces, open and flat ones, a needle.
  std::vector<TriangleMesh> many;
  for (int k = 0; k < 40; ++k) {
    many.push_back(shapes::Moved(shapes::Tetrahedron(), {2.5 * k, 0.0, 0.0}, 1.0 + k % 3));
  }
  TriangleMesh needle = shapes::SingleTriangle();
  for (Eigen::Vector3d& p : needle.positions) p[1] *= 1e-5;
  for (const TriangleMesh& mesh :
       {shapes::DisjointUnion(many), shapes::Tetrahedron(), shapes::SingleTriangle(), needle,
        methods_test::ThinPlate(1e-6)}) {
    const Surface surface = SurfaceOf(mesh);
    const Density density = Density::Uniform(surface);
    for (const Method& method : AllMethods()) {
      SCOPED_TRACE(method.name);
      for (const std::int64_t count : {4, 100}) {
        const Points points = Sample(method.name, surface, density, count);
        EXPECT_EQ(points.size(), static_cast<std::size_t>(count));
        ExpectOnSurface(surface, points);
      }
    }
  }
}

TEST(AllMethods, SameSeedSameBitsOtherSeedOtherPoints) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 40, 20));
  const Density density = DensityOf(torus, [](const auto& p) { return 2.0 + p.x(); });
  for (const Method& method : AllMethods()) {
    SCOPED_TRACE(method.name);
    const Points points = Sample(method.name, torus, density, 400, 7);
    EXPECT_TRUE(SameBits(points, Sample(method.name, torus, density, 400, 7)));
    EXPECT_FALSE(SameBits(points, Sample(method.name, torus, density, 400, 8)));
  }
}

TEST(AllMethods, StopRequestedBeforeGivesCancelled) {
  const Surface torus = SurfaceOf(shapes::Torus(1.0, 0.4, 40, 20));
  const Density density = Density::Uniform(torus);
  std::stop_source stop;
  stop.request_stop();
  for (const Method& method : AllMethods()) {
    SCOPED_TRACE(method.name);
    Interrupt interrupt(stop.get_token());
    const auto points = method.run(torus, density, 1000, 1, {&interrupt});
    EXPECT_EQ(points.status().code(), absl::StatusCode::kCancelled) << points.status();
  }
}

// Shares of 16 bands of equal capacity under rho = exp(2 z) on the unit sphere, where the integral
// over a band is proportional to the difference of exp(2 z) at its ends.
TEST(AllMethods, FollowTheDensity) {
  const Surface sphere = SurfaceOf(shapes::Icosphere(4));
  const Density density = DensityOf(sphere, [](const auto& p) { return std::exp(2.0 * p.z()); });
  constexpr int kCount = 3200;
  constexpr int kBands = 16;
  // Largest deviation of a band's share from 1 / 16, over 1 / 16. White noise: 4.5 standard
  // deviations of the binomial distribution.
  const std::map<std::string, double> bounds = {
      {"white noise", 4.5 * std::sqrt((kBands - 1.0) / kCount)},
      {"dart throwing", 0.1},
      {"elimination", 0.1},
      {"lloyd", 0.05},
      {"balanced voronoi", 0.08}};
  for (const Method& method : AllMethods()) {
    std::array<int, kBands> found{};
    for (const SurfacePoint& point : Sample(method.name, sphere, density, kCount)) {
      const double z = sphere.ToMesh(point.position).z();
      const double share = (std::exp(2.0 * z) - std::exp(-2.0)) / (std::exp(2.0) - std::exp(-2.0));
      ++found[std::clamp(static_cast<int>(share * kBands), 0, kBands - 1)];
    }
    double worst = 0.0;
    for (const int n : found) {
      worst = std::max(worst, std::abs(static_cast<double>(n) * kBands / kCount - 1.0));
    }
    EXPECT_LE(worst, bounds.at(method.name)) << method.name;
  }
}

}  // namespace
}  // namespace ccst
