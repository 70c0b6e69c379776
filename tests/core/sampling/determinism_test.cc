#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using sampling_test::FindDifference;

class Listener : public ProgressSink {
 public:
  void OnPhase(Phase) override {}
  void OnAlternation(const AlternationReport& report) override {
    for (const Eigen::Vector3d& p : report.positions) sum_ += p.x();
  }

 private:
  double sum_ = 0.0;
};

void ExpectTheSameBits(const TriangleMesh& mesh, std::int64_t count) {
  SamplingOptions options;
  options.sample_count = count;
  options.seed = 42;
  const SamplingResult base = *SampleSurface(mesh, options);
  EXPECT_EQ(FindDifference(base, *SampleSurface(mesh, options)), "") << "second run";
  Listener listener;
  EXPECT_EQ(
      FindDifference(base, *SampleSurface(mesh, options, {.stop = {}, .progress = &listener})), "")
      << "with a listener";
  for (const int threads : {2, 3, 8}) {
    options.thread_count = threads;
    EXPECT_EQ(FindDifference(base, *SampleSurface(mesh, options)), "") << threads << " threads";
  }
  EXPECT_EQ(
      FindDifference(base, *SampleSurface(mesh, options, {.stop = {}, .progress = &listener})), "")
      << "8 threads with a listener";
  std::stop_source never;
  options.time_limit_seconds = 1e6;
  EXPECT_EQ(FindDifference(base, *SampleSurface(mesh, options,
                                                {.stop = never.get_token(), .progress = nullptr})),
            "")
      << "with a stop token and a time limit that do not act";
}

TEST(Determinism, ClosedSurfaceGivesTheSameBits) {
  ExpectTheSameBits(shapes::Torus(1, 0.35, 60, 24), 700);
}

// So many that passes work on blocks side by side.
TEST(Determinism, ManySamplesGiveTheSameBits) {
  SamplingOptions options;
  options.sample_count = 40000;
  options.max_iterations = 4;
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 60, 24);
  const SamplingResult base = *SampleSurface(mesh, options);
  for (const int threads : {2, 3}) {
    options.thread_count = threads;
    EXPECT_EQ(FindDifference(base, *SampleSurface(mesh, options)), "") << threads << " threads";
  }
}

// So many faces that preparation and the first triangulation are cut up.
TEST(Determinism, ManyFacesGiveTheSameBits) {
  SamplingOptions options;
  options.sample_count = 300;
  options.max_iterations = 2;
  options.crease_angle = 0.8;
  const TriangleMesh mesh = shapes::Subdivided(shapes::Subdivided(shapes::Cylinder(1, 2, 60, 20)));
  const SamplingResult base = *SampleSurface(mesh, options);
  for (const int threads : {2, 3, 8}) {
    options.thread_count = threads;
    EXPECT_EQ(FindDifference(base, *SampleSurface(mesh, options)), "") << threads << " threads";
  }
}

TEST(Determinism, OpenSurfaceGivesTheSameBits) {
  ExpectTheSameBits(shapes::SphereWithHole(0.8, 30, 40), 500);
}

TEST(Determinism, PointedSurfaceGivesTheSameBits) {
  ExpectTheSameBits(sampling_test::Jack(4), 500);
}

TEST(Determinism, ComponentsGiveTheSameBits) {
  const std::vector<TriangleMesh> parts = {shapes::Icosphere(3),
                                           shapes::Moved(shapes::Cube(), {4, 0, 0})};
  ExpectTheSameBits(shapes::DisjointUnion(parts), 500);
}

}  // namespace
}  // namespace ccst
