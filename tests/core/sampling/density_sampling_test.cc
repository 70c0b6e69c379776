#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/relax/geometry_phase.h"
#include "core/sampling/sampling.h"
#include "core/sampling/start/initial_mesh.h"
#include "core/sampling/start/initial_points.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

template <typename F>
TriangleMesh WithDensity(TriangleMesh mesh, F&& value) {
  Attribute attribute;
  attribute.name = "rho";
  for (const Eigen::Vector3d& p : mesh.positions) {
    attribute.values.push_back(static_cast<float>(value(p)));
  }
  mesh.attributes.push_back(std::move(attribute));
  return mesh;
}

SamplingOptions ByAttribute(std::int64_t count) {
  SamplingOptions options;
  options.sample_count = count;
  options.density.source = DensitySource::kAttribute;
  options.density.attribute = "rho";
  return options;
}

TriangleMesh ExponentialSphere() {
  return WithDensity(shapes::Icosphere(5),
                     [](const Eigen::Vector3d& p) { return std::exp(2.0 * p.z()); });
}

// Patches of equal capacity of the unit sphere under exp(2 z): bands of z times sectors. By
// Archimedes the area is uniform in z, so the capacity below z goes with exp(2 z).
int PatchOf(const Eigen::Vector3d& p, int bands, int sectors) {
  const double low = std::exp(-2.0);
  const double high = std::exp(2.0);
  const double below = (std::exp(2.0 * p.z()) - low) / (high - low);
  const double turn = 0.5 + std::atan2(p.y(), p.x()) / (2.0 * std::numbers::pi);
  const int band = std::clamp(static_cast<int>(below * bands), 0, bands - 1);
  return band * sectors + std::clamp(static_cast<int>(turn * sectors), 0, sectors - 1);
}

TEST(DensitySampling, SharesFollowTheDensityOnASphere) {
  const TriangleMesh mesh = ExponentialSphere();
  double squares = 0.0;
  constexpr int kSeeds = 3;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SamplingOptions options = ByAttribute(4000);
    options.seed = seed;
    const SamplingResult result = *SampleSurface(mesh, options);
    EXPECT_LE(result.capacity_cv, 0.03);
    EXPECT_GE(result.relative_radius, 0.6);
    EXPECT_EQ(sampling_test::FindFault(mesh, 4000, result), "");
    std::vector<double> counts(64, 0.0);
    for (const Eigen::Vector3d& p : result.samples.positions) {
      counts[PatchOf(p.normalized(), 8, 8)] += 1.0;
    }
    for (const double count : counts) squares += std::pow(count / (4000.0 / 64.0) - 1.0, 2);
  }
  EXPECT_LE(std::sqrt(squares / (64.0 * kSeeds)), 0.035);
}

// A whole start under a density, of which the sampler itself gives only the end.
struct DensityStart {
  Surface surface;
  Density density;
  Plan plan;
  Samples samples;
  SampleMesh mesh;

  DensityStart(const TriangleMesh& shape, std::vector<double> corners, std::int64_t count)
      : surface(*Surface::Build(shape)),
        density(*Density::Linear(surface, std::move(corners), 1e6)) {
    Interrupt never;
    std::int64_t smallest = 0;
    plan = *MakePlan(surface, density, {}, count, 1, &smallest);
    samples = *DrawInitialPoints(surface, density, plan, 1, &never);
    mesh = *BuildInitialMesh(surface, plan, samples, &never);
  }
};

std::vector<double> PlaneRamp(const TriangleMesh& mesh) {
  std::vector<double> corners;
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) corners.push_back(std::exp(4.0 * mesh.positions[face[k]].x()));
  }
  return corners;
}

TEST(DensitySampling, StepMinimisesSquaredCapacities) {
  // On a plane sum (rho A)^2 is a quadratic of one sample's position, so a whole step ends where
  // its gradient is zero. With weights rho instead of rho^2 it would not.
  const TriangleMesh mesh = shapes::PlaneGrid(1, 1, 20, 20);
  int compared = 0;
  for (std::int32_t v = 20; v < 200; v += 15) {
    DensityStart start(mesh, PlaneRamp(mesh), 300);
    if (start.samples.kind[v] != SampleMesh::Kind::kInterior) continue;
    for (std::int32_t i = 0; i < start.samples.count(); ++i) {
      if (i != v) start.samples.kind[i] = SampleMesh::Kind::kFixed;
    }
    Interrupt never;
    GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kSquaredArea,
                           &start.mesh, &start.samples, &sampling_test::kOneThread);
    geometry.stretch = 1.0;
    geometry.rest = 1e-9;
    const auto energy_at = [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d kept = start.samples.position[v];
      start.samples.position[v] = p;
      double sum = 0.0;
      start.mesh.ForEachOutgoing(v, [&](std::int32_t h) {
        sum += std::pow(geometry.Capacity(SampleMesh::TriangleOf(h)), 2);
      });
      start.samples.position[v] = kept;
      return sum;
    };
    const auto slope = [&](const Eigen::Vector3d& p, int axis) {
      const Eigen::Vector3d e = 1e-6 * Eigen::Vector3d::Unit(axis);
      return (energy_at(p + e) - energy_at(p - e)) / 2e-6;
    };
    const Eigen::Vector3d before = start.samples.position[v];
    const double steep = std::hypot(slope(before, 0), slope(before, 1));
    geometry.Pass(&never);
    const Eigen::Vector3d after = start.samples.position[v];
    // Longer steps are cut short, and such as would turn a triangle over are not taken.
    if ((after - before).norm() < 1e-6 || (after - before).norm() > 0.25 * start.plan.spacing) {
      continue;
    }
    EXPECT_LT(std::hypot(slope(after, 0), slope(after, 1)), 1e-3 * steep) << "sample " << v;
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

TEST(DensitySampling, EnergyNeverRisesInAGeometryPhase) {
  const TriangleMesh mesh = shapes::PlaneGrid(1, 1, 20, 20);
  DensityStart start(mesh, PlaneRamp(mesh), 600);
  Interrupt never;
  GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget, &start.mesh,
                         &start.samples, &sampling_test::kOneThread);
  double last = geometry.MeasureCapacities().energy;
  for (int pass = 0; pass < 20; ++pass) {
    geometry.Pass(&never);
    const double now = geometry.MeasureCapacities().energy;
    EXPECT_LE(now, last * (1.0 + 1e-12));
    last = now;
  }
}

TEST(DensitySampling, BoundarySpacingFollowsTheDensity) {
  const TriangleMesh mesh =
      WithDensity(shapes::PlaneGrid(1, 1, 40, 40),
                  [](const Eigen::Vector3d& p) { return p.x() < 0.5 ? 1.0 : 9.0; });
  // So many that a sample more or less on a side is a few per cent.
  const SamplingResult result = *SampleSurface(mesh, ByAttribute(12000));
  // Spacing goes with 1 / sqrt(rho): three times as many along the dense halves of two sides.
  int sparse = 0;
  int dense = 0;
  for (const Eigen::Vector3d& p : result.samples.positions) {
    if (p.y() > 1e-9 && p.y() < 1.0 - 1e-9) continue;
    sparse += p.x() < 0.45;
    dense += p.x() > 0.55;
  }
  EXPECT_NEAR(static_cast<double>(dense) / sparse, 3.0, 0.4);
}

TEST(DensitySampling, TextureRampIsFollowed) {
  TriangleMesh mesh = shapes::PlaneGrid(1, 1, 2, 2);
  Attribute uv;
  uv.name = "uv";
  uv.kind = AttributeKind::kTextureCoordinates;
  uv.components = 2;
  for (const Eigen::Vector3d& p : mesh.positions) {
    uv.values.push_back(static_cast<float>(p.x()));
    uv.values.push_back(static_cast<float>(p.y()));
  }
  mesh.attributes.push_back(std::move(uv));
  auto image = std::make_shared<Image>();
  *image = {256, 1, {}};
  // Density 0.1 + 0.9 u; half a pixel at either end wraps around.
  for (int x = 0; x < 256; ++x) {
    image->values.push_back(static_cast<float>(0.9 - 0.9 * (x + 0.5) / 256.0));
  }
  SamplingOptions options;
  options.sample_count = 4096;
  options.density.source = DensitySource::kTexture;
  options.density.image = image;
  const SamplingResult result = *SampleSurface(mesh, options);
  double squares = 0.0;
  constexpr int kBands = 16;
  constexpr int kRows = 4;
  std::vector<double> counts(kBands * kRows, 0.0);
  for (const Eigen::Vector3d& p : result.samples.positions) {
    const double below = (0.1 * p.x() + 0.45 * p.x() * p.x()) / 0.55;
    const int band = std::clamp(static_cast<int>(below * kBands), 0, kBands - 1);
    counts[band * kRows + std::clamp(static_cast<int>(p.y() * kRows), 0, kRows - 1)] += 1.0;
  }
  // Samples on the boundary stand for half as much.
  for (int band = 1; band + 1 < kBands; ++band) {
    for (int row = 1; row + 1 < kRows; ++row) {
      const double expected = 4096.0 / (kBands * kRows);
      squares += std::pow(counts[band * kRows + row] / expected - 1.0, 2);
    }
  }
  EXPECT_LE(std::sqrt(squares / ((kBands - 2) * (kRows - 2))), 0.05);
}

TEST(DensitySampling, CurvatureGathersSamplesWhereATorusBendsMost) {
  // sqrt|k1 k2| of a torus is sqrt(|cos t| / (r (R + r cos t))): more outside and inside, none on
  // top; the tube's share between two angles is the integral of sqrt(|cos t| (R + r cos t)).
  const double large = 1.0;
  const double small = 0.4;
  SamplingOptions options;
  options.sample_count = 3000;
  options.density.source = DensitySource::kCurvature;
  const SamplingResult result = *SampleSurface(shapes::Torus(large, small, 160, 96), options);
  constexpr int kBins = 8;
  std::vector<double> expected(kBins, 0.0);
  std::vector<double> counts(kBins, 0.0);
  double total = 0.0;
  for (int i = 0; i < 8000; ++i) {
    const double t = (i + 0.5) / 8000.0 * 2.0 * std::numbers::pi;
    const double share = std::sqrt(std::abs(std::cos(t)) * (large + small * std::cos(t)));
    expected[i * kBins / 8000] += share;
    total += share;
  }
  for (const Eigen::Vector3d& p : result.samples.positions) {
    double t = std::atan2(p.z(), std::hypot(p.x(), p.y()) - large);
    if (t < 0.0) t += 2.0 * std::numbers::pi;
    counts[std::clamp(static_cast<int>(t / (2.0 * std::numbers::pi) * kBins), 0, kBins - 1)] += 1;
  }
  for (int bin = 0; bin < kBins; ++bin) {
    EXPECT_NEAR(counts[bin] / 3000.0, expected[bin] / total, 0.01) << bin;
  }
}

TEST(DensitySampling, RefusesAnAttributeThatIsNotThereAndNamesThoseThatAre) {
  const TriangleMesh mesh = ExponentialSphere();
  SamplingOptions options = ByAttribute(100);
  options.density.attribute = "heat";
  const absl::Status status = SampleSurface(mesh, options).status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kDensityInvalid);
  EXPECT_NE(status.message().find("it has rho"), std::string::npos) << status.message();
}

TEST(DensitySampling, RefusesANegativeDensity) {
  TriangleMesh mesh = ExponentialSphere();
  mesh.attributes[0].values[7] = -0.5F;
  const absl::Status status = SampleSurface(mesh, ByAttribute(100)).status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kDensityInvalid);
  EXPECT_NE(status.message().find("-0.5"), std::string::npos) << status.message();
}

TEST(DensitySampling, RefusesCurvatureOnAPlane) {
  SamplingOptions options;
  options.sample_count = 100;
  options.density.source = DensitySource::kCurvature;
  EXPECT_EQ(GetErrorReason(SampleSurface(shapes::PlaneGrid(1, 1, 4, 4), options).status()),
            ErrorReason::kDensityInvalid);
}

}  // namespace
}  // namespace ccst::internal
