#include "core/sampling/input/prepared_surface.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

SamplingOptions Options(std::int64_t count, SamplingMethod method = SamplingMethod::kCcst) {
  SamplingOptions options;
  options.sample_count = count;
  options.method = method;
  return options;
}

// The largest distance from where the sources say that the corners of the faces lie on the input
// to where they lie.
double LargestError(const TriangleMesh& input, const PreparedSurface& prepared) {
  double largest = 0.0;
  for (std::int32_t f = 0; f < prepared.surface.face_count(); ++f) {
    const Eigen::Vector3i& source = input.faces[prepared.sources.Face(f)];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d w = prepared.sources.Corner(f, k);
      const Eigen::Vector3d place = w[0] * input.positions[source[0]] +
                                    w[1] * input.positions[source[1]] +
                                    w[2] * input.positions[source[2]];
      const Eigen::Vector3d& corner = prepared.surface.positions()[prepared.surface.faces()[f][k]];
      largest = std::max(largest, (place - prepared.surface.ToMesh(corner)).norm());
    }
  }
  return largest;
}

TEST(Prepare, SamplingSplitsLargeFacesAtSharpEdges) {
  const PreparedSurface prepared = *Prepare(shapes::Cube(), Options(1000), Purpose::kSampling);
  EXPECT_GT(prepared.surface.face_count(), 1000);
}

TEST(Prepare, CountsAreThoseBeforeFacesWereSplit) {
  const PreparedSurface prepared = *Prepare(shapes::Cube(), Options(1000), Purpose::kSampling);
  EXPECT_EQ(prepared.vertex_count, 8);
  EXPECT_EQ(prepared.face_count, 12);
}

TEST(Prepare, OtherMethodsLeaveFacesWhole) {
  const PreparedSurface prepared =
      *Prepare(shapes::Cube(), Options(1000, SamplingMethod::kPoissonDisk), Purpose::kSampling);
  EXPECT_EQ(prepared.surface.face_count(), 12);
}

TEST(Prepare, MeasuringKeepsTheFacesAsTheyAre) {
  const TriangleMesh cube = shapes::Cube();
  const PreparedSurface prepared = *Prepare(cube, Options(1000), Purpose::kMeasuring);
  EXPECT_EQ(prepared.surface.faces(), cube.faces);
}

TEST(Prepare, SourcesLeadFromSortedAndSplitFacesToTheInput) {
  const TriangleMesh cube = shapes::Cube();
  const PreparedSurface prepared = *Prepare(cube, Options(1000), Purpose::kSampling);
  EXPECT_LE(LargestError(cube, prepared), 1e-14);
}

TEST(Prepare, RepairsAreReported) {
  const PreparedSurface prepared =
      *Prepare(shapes::Unwelded(shapes::Icosphere(2)), Options(100), Purpose::kSampling);
  EXPECT_EQ(prepared.repairs.welded_vertices, 3 * 320 - 162);
}

TEST(Prepare, WeldToleranceIsThatOfTheOptions) {
  TriangleMesh mesh = shapes::Unwelded(shapes::PlaneGrid(1.0, 1.0, 1, 1));
  ASSERT_EQ(mesh.positions.size(), 6u);
  for (std::size_t v = 3; v < 6; ++v) mesh.positions[v].x() += 1e-3;
  SamplingOptions options = Options(100);
  EXPECT_EQ(Prepare(mesh, options, Purpose::kSampling)->surface.component_areas().size(), 2u);
  options.weld_tolerance = 2e-3;
  EXPECT_EQ(Prepare(mesh, options, Purpose::kSampling)->surface.component_areas().size(), 1u);
}

TEST(Prepare, DensityIsOnTheSplitFaces) {
  const PreparedSurface prepared = *Prepare(shapes::Cube(), Options(1000), Purpose::kSampling);
  const std::vector<double>& capacities = prepared.density.face_capacities();
  ASSERT_EQ(static_cast<std::int32_t>(capacities.size()), prepared.surface.face_count());
  EXPECT_NEAR(std::accumulate(capacities.begin(), capacities.end(), 0.0), prepared.surface.area(),
              1e-12);
}

TEST(Prepare, StopIsAnError) {
  std::stop_source source;
  source.request_stop();
  Interrupt interrupt(source.get_token());
  const auto prepared = Prepare(shapes::Icosphere(3), Options(100), Purpose::kSampling, &interrupt);
  EXPECT_EQ(GetErrorReason(prepared.status()), ErrorReason::kCancelled);
}

TEST(Prepare, MeshWithoutFacesIsRefused) {
  const auto prepared = Prepare(TriangleMesh(), Options(100), Purpose::kMeasuring);
  EXPECT_EQ(GetErrorReason(prepared.status()), ErrorReason::kMeshEmpty);
}

TEST(Prepare, DensityOfAnUnknownAttributeIsRefused) {
  SamplingOptions options = Options(100);
  options.density.source = DensitySource::kAttribute;
  options.density.attribute = "heat";
  const auto prepared = Prepare(shapes::Cube(), options, Purpose::kMeasuring);
  EXPECT_EQ(GetErrorReason(prepared.status()), ErrorReason::kDensityInvalid);
}

TEST(Prepare, ThreadsChangeNothing) {
  const TriangleMesh torus = shapes::Torus(1.0, 0.35, 200, 100);
  const PreparedSurface one = *Prepare(torus, Options(100), Purpose::kSampling);
  const PreparedSurface three =
      *Prepare(torus, Options(100), Purpose::kSampling, nullptr, Parallel(3));
  EXPECT_EQ(one.surface.faces(), three.surface.faces());
  EXPECT_EQ(one.surface.positions(), three.surface.positions());
}

}  // namespace
}  // namespace ccst::internal
