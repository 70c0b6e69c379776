#include "tests/figures/figures.h"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/figures/floors.h"
#include "tests/figures/report.h"
#include "tests/support/shapes.h"

namespace ccst::figures {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;

// Coarse, so that the tests stay quick under sanitizers.
constexpr double kSpacing = 0.1;

// A sample at every vertex of `mesh`, joined by its faces; normals are those of a sphere.
SampleSet SampleVertices(const TriangleMesh& mesh) {
  SampleSet samples;
  samples.positions = mesh.positions;
  samples.triangles = mesh.faces;
  samples.faces.resize(mesh.positions.size());
  samples.barycentrics.resize(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int slot = 0; slot < 3; ++slot) {
      samples.faces[mesh.faces[f][slot]] = static_cast<std::int32_t>(f);
      samples.barycentrics[mesh.faces[f][slot]] = {slot == 0 ? 1.0 : 0.0, slot == 1 ? 1.0 : 0.0};
    }
  }
  for (const Eigen::Vector3d& p : mesh.positions) samples.normals.push_back(p.normalized());
  return samples;
}

// The samples of a subdivided icosphere are within every floor but the cv of small counts:
// icospheres are a little uneven. Their own mesh is the surface.
class IcosphereFigures : public testing::Test {
 protected:
  std::set<std::string, std::less<>> Misses() const {
    return FindMisses(MeasureFigures(mesh_, surface_, samples_, kSpacing), surface_, count_, 0);
  }

  TriangleMesh mesh_ = shapes::Icosphere(3);
  ReferenceSurface surface_{mesh_};
  SampleSet samples_ = SampleVertices(mesh_);
  std::int64_t count_ = static_cast<std::int64_t>(mesh_.positions.size());
};

TEST_F(IcosphereFigures, MatchTheirClosedForms) {
  const Figures figures = MeasureFigures(mesh_, surface_, samples_, kSpacing);
  EXPECT_EQ(figures.samples, 642);
  EXPECT_LT(figures.max_distance, 1e-15);
  EXPECT_EQ(figures.max_host_error, 0.0);
  EXPECT_EQ(figures.euler, 2);
  EXPECT_EQ(figures.components, 1);
  EXPECT_EQ(figures.boundary_loops, 0);
  EXPECT_EQ(figures.turned_over, 0);
  EXPECT_EQ(figures.defect, "");
  EXPECT_EQ(figures.valence_5_7, 1.0);
  EXPECT_GT(figures.min_angle, 50.0);
  EXPECT_GT(figures.radius_same_side, 0.8);
  EXPECT_LE(figures.radius, figures.radius_same_side);
  EXPECT_LT(figures.hausdorff, 1e-15);
  EXPECT_LT(figures.capacity_cv, 0.1);
}

TEST_F(IcosphereFigures, MissNothingButTheVariationOfIcospheres) {
  EXPECT_THAT(Misses(), ElementsAre("cv"));
}

TEST_F(IcosphereFigures, MissingSampleIsFound) {
  ++count_;
  EXPECT_THAT(Misses(), ElementsAre("cv", "n"));
}

TEST_F(IcosphereFigures, SampleOffTheSurfaceIsFound) {
  samples_.positions[5] *= 1.0 + 1e-5;
  EXPECT_THAT(Misses(), ElementsAre("cv", "host", "maxdist"));
}

TEST_F(IcosphereFigures, WrongHostIsFound) {
  samples_.faces[5] = -1;
  EXPECT_THAT(Misses(), IsSupersetOf({"host"}));
  samples_.faces[5] = 1280;
  EXPECT_THAT(Misses(), IsSupersetOf({"host"}));
  samples_.faces[5] = samples_.faces[6];
  EXPECT_THAT(Misses(), IsSupersetOf({"host"}));
  samples_ = SampleVertices(mesh_);
  samples_.barycentrics[5] = {-0.1, 0.5};
  EXPECT_THAT(Misses(), IsSupersetOf({"host"}));
}

TEST_F(IcosphereFigures, CrowdedPairIsFoundAndNamed) {
  // Vertex 642 beside vertex 0 splits a face.
  const Eigen::Vector3i t = mesh_.faces[0];
  samples_.positions.push_back(0.9 * mesh_.positions[t[0]] + 0.05 * mesh_.positions[t[1]] +
                               0.05 * mesh_.positions[t[2]]);
  samples_.normals.push_back(samples_.positions.back().normalized());
  samples_.faces.push_back(0);
  samples_.barycentrics.emplace_back(0.9, 0.05);
  samples_.triangles[0] = {t[0], t[1], 642};
  samples_.triangles.emplace_back(t[1], t[2], 642);
  samples_.triangles.emplace_back(t[2], t[0], 642);
  ++count_;
  EXPECT_THAT(Misses(), IsSupersetOf({"cv", "minAngle", "radius"}));
  EXPECT_THAT(MeasureFigures(mesh_, surface_, samples_, kSpacing).closest_pair,
              AllOf(HasSubstr("642"), HasSubstr(", joined")));
}

TEST_F(IcosphereFigures, BrokenSampleMeshIsFound) {
  std::swap(samples_.triangles[3][0], samples_.triangles[3][1]);
  EXPECT_THAT(Misses(), IsSupersetOf({"manifold", "turned"}));
  samples_ = SampleVertices(mesh_);
  samples_.triangles.pop_back();
  EXPECT_THAT(Misses(), IsSupersetOf({"euler", "loops"}));
  samples_.triangles.emplace_back(0, 1, 5000);
  EXPECT_THAT(Misses(), IsSupersetOf({"manifold", "maxdist"}));
  samples_.triangles.clear();
  EXPECT_THAT(Misses(), IsSupersetOf({"manifold"}));
}

TEST_F(IcosphereFigures, MissingTipShowsInTheHausdorffDistance) {
  // An octahedron on the sphere: 0.42 from it at the middles of its faces.
  const TriangleMesh octahedron = shapes::UvSphere(2, 4);
  Figures figures = MeasureFigures(octahedron, surface_, SampleVertices(octahedron), kSpacing);
  EXPECT_NEAR(figures.hausdorff * surface_.diagonal(), 1.0 - 1.0 / std::sqrt(3.0), 5e-3);
}

TEST_F(IcosphereFigures, SampleThatIsNotANumberMisses) {
  samples_.positions[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(Misses(), IsSupersetOf({"manifold", "host"}));
}

TEST(ReferenceSurface, WeldsAndDropsWhatHasNoFace) {
  const TriangleMesh input =
      shapes::WithIsolatedVertices(shapes::Unwelded(shapes::Torus(1.0, 0.3, 12, 8)), 7);
  const ReferenceSurface surface(input);
  EXPECT_EQ(surface.mesh().positions.size(), 96u);
  EXPECT_EQ(surface.mesh().faces.size(), input.faces.size());
  EXPECT_EQ(surface.topology().euler, 0);
  EXPECT_TRUE(surface.topology().IsManifold());
  EXPECT_FALSE(surface.IsOpen());
}

TEST(ReferenceSurface, TellsCreasedFromSmooth) {
  EXPECT_FALSE(ReferenceSurface(shapes::Icosphere(4)).IsCreased());
  EXPECT_TRUE(ReferenceSurface(shapes::Cube()).IsCreased());
  EXPECT_NEAR(ReferenceSurface(shapes::Cube()).sharp_share(), 12.0 / 18.0, 1e-12);
}

TEST(Floors, DependOnTheKindOfSurface) {
  const ReferenceSurface closed(shapes::Icosphere(3));
  const ReferenceSurface open(shapes::PlaneGrid(1.0, 1.0, 4, 4));
  const ReferenceSurface creased(shapes::Cube());
  EXPECT_EQ(FloorsFor(closed, 2000).capacity_cv, 0.05);
  EXPECT_EQ(FloorsFor(closed, 4000).capacity_cv, 0.03);
  EXPECT_EQ(FloorsFor(open, 20000).capacity_cv, 0.05);
  EXPECT_EQ(FloorsFor(closed, 4000).hausdorff, 0.015);
  EXPECT_EQ(FloorsFor(open, 4000).hausdorff, 0.02);
  EXPECT_TRUE(std::isinf(FloorsFor(open, 2000).hausdorff));
  EXPECT_EQ(FloorsFor(closed, 4000).min_angle, 25.0);
  EXPECT_EQ(FloorsFor(open, 4000).min_angle, 18.0);
  EXPECT_EQ(FloorsFor(creased, 4000).valence_5_7, 0.985);
  EXPECT_EQ(FloorsFor(open, 4000).valence_5_7, 0.995);
}

TEST(Floors, OnlyShortLoopsMayBeClosed) {
  // The hole is 0.3 around; r_max of 162 samples is about 0.3, of 20000 about 0.027.
  const TriangleMesh holed = shapes::SphereWithHole(0.05, 12, 24);
  const ReferenceSurface surface(holed);
  TriangleMesh closed = shapes::Icosphere(2);
  Figures figures = MeasureFigures(holed, surface, SampleVertices(closed), kSpacing);
  const auto misses = [&](std::int64_t count, std::int64_t closed_loops) {
    return FindMisses(figures, surface, count, closed_loops);
  };
  EXPECT_EQ(misses(162, 1).count("loops") + misses(162, 1).count("euler"), 0u);
  EXPECT_EQ(misses(162, 1).count("closed"), 0u);
  EXPECT_EQ(misses(162, 0).count("loops"), 1u);
  EXPECT_EQ(misses(162, 0).count("euler"), 1u);
  EXPECT_EQ(misses(20000, 1).count("closed"), 1u);
}

TEST(Report, MarksWhatMissesAndAlignsRows) {
  RunRecord run;
  run.model = "sphere";
  run.sample_count = 642;
  run.figures.capacity_cv = 0.5;
  run.figures.closest_pair = "samples 1 and 2";
  const std::string clean = FormatRow(run, 10);
  EXPECT_EQ(clean.size(), FormatHeader(10).size());
  EXPECT_EQ(clean.find('*'), std::string::npos);
  run.misses = {"cv", "radius"};
  const std::string marked = FormatRow(run, 10);
  EXPECT_THAT(marked, HasSubstr("0.5000*"));
  EXPECT_THAT(marked, HasSubstr("too close: samples 1 and 2"));
  EXPECT_THAT(FormatJson(run), HasSubstr("\"misses\":[\"cv\",\"radius\"]"));
  EXPECT_FALSE(run.Holds());
  run.error = "no such file";
  EXPECT_THAT(FormatRow(run, 10), HasSubstr("* no such file"));
}

TEST(Report, EveryMissIsAColumn) {
  Figures nothing;
  nothing.defect = "empty";
  nothing.max_distance = nothing.max_host_error = nothing.capacity_cv = nothing.hausdorff = NAN;
  nothing.turned_over = nothing.euler = nothing.components = nothing.boundary_loops = -99;
  nothing.below_30 = 1.0;
  RunRecord run;
  run.sample_count = 4000;
  run.misses = FindMisses(nothing, ReferenceSurface(shapes::Icosphere(2)), 4000, -1);
  EXPECT_EQ(run.misses.size(), 15u);
  run.figures.defect = "x";
  std::string row = FormatRow(run, 10);
  row = row.substr(0, row.find('\n'));
  EXPECT_EQ(std::count(row.begin(), row.end(), '*'), 15);
}

}  // namespace
}  // namespace ccst::figures
