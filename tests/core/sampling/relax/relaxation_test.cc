#include "core/sampling/relax/relaxation.h"

#include <chrono>
#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/quality/capacity.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::internal {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;
using sampling_test::Triangles;

constexpr Interrupt::Clock::duration kNoReserve = Interrupt::Clock::duration::zero();

SamplingOptions Options() {
  SamplingOptions options;
  options.sample_count = 400;
  return options;
}

Start Torus() { return *MakeStart(shapes::Torus(1.0, 0.35, 60, 24), 400); }

absl::StatusOr<RelaxationReport> Relax(Start* start, const SamplingOptions& options,
                                       Interrupt* interrupt, Relaxation::Listeners listeners = {},
                                       Interrupt::Clock::duration reserve = kNoReserve) {
  Relaxation relaxation(&start->surface, &start->density, &start->plan, options,
                        std::move(listeners), interrupt, reserve, &start->mesh, &start->samples);
  return relaxation.Run();
}

TEST(Relaxation, EvensOutTheCapacities) {
  Start start = Torus();
  Interrupt never;
  std::vector<double> variations;
  const auto note = [&](const AlternationReport& alternation) {
    variations.push_back(alternation.capacity_cv);
  };
  const RelaxationReport report = *Relax(&start, Options(), &never, {.on_alternation = note});
  EXPECT_EQ(report.termination, Termination::kConverged);
  EXPECT_LE(report.capacity_cv, 0.1 * variations.front());
}

TEST(Relaxation, ListenerHearsOfEveryAlternationAndOfTheStart) {
  Start start = Torus();
  Interrupt never;
  std::vector<int> heard;
  const auto note = [&](const AlternationReport& alternation) {
    heard.push_back(alternation.alternation);
  };
  const RelaxationReport report = *Relax(&start, Options(), &never, {.on_alternation = note});
  ASSERT_EQ(static_cast<int>(heard.size()), report.alternations + 1);
  for (int i = 0; i <= report.alternations; ++i) EXPECT_EQ(heard[i], i);
}

TEST(Relaxation, VariationIsThatOfTheTrianglesItLeaves) {
  Start start = Torus();
  Interrupt never;
  const RelaxationReport report = *Relax(&start, Options(), &never);
  const std::vector<Eigen::Vector3i> triangles = Triangles(start.mesh);
  EXPECT_NEAR(report.capacity_cv, quality::MeasureCapacities(start.samples.position, triangles).cv,
              1e-12);
}

TEST(Relaxation, EndsAtTheLimitOfAlternations) {
  Start start = Torus();
  Interrupt never;
  SamplingOptions options = Options();
  options.max_iterations = 7;
  const RelaxationReport report = *Relax(&start, options, &never);
  EXPECT_EQ(report.termination, Termination::kIterationLimit);
  EXPECT_EQ(report.alternations, 7);
  EXPECT_EQ(report.passes, 21);
}

TEST(Relaxation, StopBeforeTheFirstCapacitiesIsAnError) {
  Start start = Torus();
  std::stop_source source;
  source.request_stop();
  Interrupt interrupt(source.get_token());
  const auto report = Relax(&start, Options(), &interrupt);
  EXPECT_EQ(GetErrorReason(report.status()), ErrorReason::kCancelled);
}

TEST(Relaxation, StopAtAnAlternationLeavesAWholeMesh) {
  Start start = Torus();
  std::stop_source source;
  Interrupt interrupt(source.get_token());
  const auto stop = [&](const AlternationReport& alternation) {
    if (alternation.alternation == 6) source.request_stop();
  };
  const RelaxationReport report = *Relax(&start, Options(), &interrupt, {.on_alternation = stop});
  EXPECT_EQ(report.termination, Termination::kStopped);
  EXPECT_EQ(report.alternations, 6);
  const quality::MeshTopology topology = sampling_test::Topology(start.mesh);
  EXPECT_EQ(topology.first_defect, "");
  EXPECT_EQ(topology.euler, 0);
}

TEST(Relaxation, StagesComeInTheirOrder) {
  Start start = Torus();
  Interrupt never;
  std::vector<Stage> stages;
  const auto note = [&](Stage stage) { stages.push_back(stage); };
  ASSERT_TRUE(Relax(&start, Options(), &never, {.on_stage = note}).ok());
  const std::vector<Stage> expected = {Stage::kEarly, Stage::kMended, Stage::kConverged,
                                       Stage::kRelaxed};
  EXPECT_EQ(stages, expected);
}

TEST(Relaxation, ReserveIsTakenFromTheTimeLimit) {
  Start start = Torus();
  using std::chrono::hours;
  Interrupt interrupt({}, Interrupt::Clock::now() + hours(1));
  const RelaxationReport report = *Relax(&start, Options(), &interrupt, {}, hours(2));
  EXPECT_EQ(report.termination, Termination::kTimeLimit);
  EXPECT_EQ(report.alternations, 0);
}

}  // namespace
}  // namespace ccst::internal
