#include "core/sampling/run_control.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using sampling_test::FindDifference;
using sampling_test::FindFault;

// Keeps what it is told and checks the contract on the way.
class Recorder : public ProgressSink {
 public:
  void OnPhase(Phase phase) override {
    EXPECT_EQ(std::this_thread::get_id(), thread_);
    phases.push_back(phase);
    if (on_phase) on_phase(phase);
  }
  void OnAlternation(const AlternationReport& report) override {
    EXPECT_EQ(std::this_thread::get_id(), thread_);
    ASSERT_FALSE(phases.empty());
    EXPECT_EQ(phases.back(), Phase::kRelaxing);
    reports.push_back(report);
    positions.assign(report.positions.begin(), report.positions.end());
    reports.back().positions = {};
    if (on_alternation) on_alternation(report);
  }

  std::function<void(Phase)> on_phase;
  std::function<void(const AlternationReport&)> on_alternation;
  std::vector<Phase> phases;
  std::vector<AlternationReport> reports;
  std::vector<Eigen::Vector3d> positions;  // Of the last report.

 private:
  std::thread::id thread_ = std::this_thread::get_id();
};

const std::vector<Phase> kAllPhases = {Phase::kPreparing, Phase::kInitializing, Phase::kRelaxing,
                                       Phase::kFinalizing};

std::vector<Eigen::Vector3d> Sorted(std::vector<Eigen::Vector3d> positions) {
  std::sort(positions.begin(), positions.end(),
            [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
              return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
            });
  return positions;
}

SamplingOptions Options(std::int64_t count) {
  SamplingOptions options;
  options.sample_count = count;
  return options;
}

TEST(RunControl, ProgressKeepsItsContract) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 60, 24);
  Recorder recorder;
  std::size_t count = 0;
  recorder.on_alternation = [&](const AlternationReport& report) {
    EXPECT_EQ(report.positions.size(), 600u);
    for (const Eigen::Vector3d& p : report.positions) {
      // In mesh units, on the torus.
      const double ring = std::hypot(p.x(), p.y()) - 1.0;
      EXPECT_NEAR(std::hypot(ring, p.z()), 0.35, 0.02);
    }
    ++count;
  };
  const SamplingOptions options = Options(600);
  const SamplingResult result = *SampleSurface(mesh, options, {.stop = {}, .progress = &recorder});
  EXPECT_EQ(recorder.phases, kAllPhases);
  ASSERT_EQ(recorder.reports.size(), count);
  ASSERT_FALSE(recorder.reports.empty());
  EXPECT_EQ(recorder.reports.front().alternation, 0);
  EXPECT_EQ(recorder.reports.back().alternation, result.alternations);
  for (std::size_t i = 0; i < recorder.reports.size(); ++i) {
    const AlternationReport& report = recorder.reports[i];
    EXPECT_EQ(report.alternation, static_cast<int>(i));
    EXPECT_EQ(report.alternation_limit, options.max_iterations);
    EXPECT_TRUE(std::isfinite(report.energy));
    EXPECT_GT(report.capacity_cv, 0.0);
    EXPECT_GE(report.flips, 0);
    EXPECT_GE(report.relocations, 0);
    EXPECT_GE(report.max_displacement, 0.0);
    if (i > 0) {
      EXPECT_GE(report.elapsed_seconds, recorder.reports[i - 1].elapsed_seconds);
    }
  }
  EXPECT_LT(recorder.reports.back().capacity_cv, recorder.reports.front().capacity_cv);
  EXPECT_GE(result.prepare_seconds, 0.0);
  EXPECT_GE(result.initialise_seconds, 0.0);
  EXPECT_GE(result.optimise_seconds, 0.0);
}

TEST(RunControl, StopBeforeTheStartIsCancelled) {
  std::stop_source stop;
  stop.request_stop();
  Recorder recorder;
  const absl::Status status = SampleSurface(shapes::Icosphere(3), Options(500),
                                            {.stop = stop.get_token(), .progress = &recorder})
                                  .status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
  EXPECT_TRUE(recorder.reports.empty());
}

TEST(RunControl, ValidationComesBeforeAStop) {
  std::stop_source stop;
  stop.request_stop();
  const RunControl run = {.stop = stop.get_token(), .progress = nullptr};
  EXPECT_EQ(SampleSurface(shapes::Icosphere(1), Options(0), run).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(RunControl, StopWhilePreparingOrInitialisingIsCancelled) {
  for (const Phase phase : {Phase::kPreparing, Phase::kInitializing}) {
    std::stop_source stop;
    Recorder recorder;
    recorder.on_phase = [&](Phase now) {
      if (now == phase) stop.request_stop();
    };
    const absl::Status status = SampleSurface(shapes::Icosphere(5), Options(20000),
                                              {.stop = stop.get_token(), .progress = &recorder})
                                    .status();
    EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
    EXPECT_EQ(recorder.phases.back(), phase);
  }
}

TEST(RunControl, StopInTheMiddleReturnsAWholeIterate) {
  const std::vector<TriangleMesh> meshes = {shapes::Torus(1, 0.35, 60, 24),
                                            shapes::SphereWithHole(0.8, 30, 40)};
  for (const TriangleMesh& mesh : meshes) {
    for (const int at : {0, 1, 2, 4, 7}) {
      std::stop_source stop;
      Recorder recorder;
      recorder.on_alternation = [&](const AlternationReport& report) {
        if (report.alternation == at) stop.request_stop();
      };
      const absl::StatusOr<SamplingResult> result =
          SampleSurface(mesh, Options(600), {.stop = stop.get_token(), .progress = &recorder});
      ASSERT_TRUE(result.ok()) << result.status();
      EXPECT_EQ(result->termination, Termination::kStopped);
      EXPECT_EQ(recorder.reports.back().alternation, at);
      EXPECT_EQ(FindFault(mesh, 600, *result), "");
      EXPECT_EQ(recorder.phases, kAllPhases);
    }
  }
}

TEST(RunControl, StoppedEarlyIsTheIterateThatWasReported) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 60, 24);
  std::stop_source stop;
  Recorder recorder;
  recorder.on_alternation = [&](const AlternationReport& report) {
    if (report.alternation == 5) stop.request_stop();
  };
  const SamplingResult stopped =
      *SampleSurface(mesh, Options(600), {.stop = stop.get_token(), .progress = &recorder});
  SamplingOptions five = Options(600);
  five.max_iterations = 5;
  const SamplingResult limited = *SampleSurface(mesh, five);
  EXPECT_EQ(limited.termination, Termination::kIterationLimit);
  // The samples of the whole run are in an order of their own.
  EXPECT_EQ(Sorted(stopped.samples.positions), Sorted(limited.samples.positions));
  EXPECT_EQ(stopped.samples.triangles.size(), limited.samples.triangles.size());
  for (std::size_t i = 0; i < recorder.positions.size(); ++i) {
    EXPECT_LT((recorder.positions[i] - stopped.samples.positions[i]).norm(), 1e-12);
  }
}

TEST(RunControl, StopWhileFinalizingReturnsTheSamplesInAnyOrder) {
  const TriangleMesh mesh = shapes::Icosphere(3);
  for (const SamplingMethod method : {SamplingMethod::kCcst, SamplingMethod::kLloyd}) {
    std::stop_source stop;
    Recorder recorder;
    recorder.on_phase = [&](Phase phase) {
      if (phase == Phase::kFinalizing) stop.request_stop();
    };
    SamplingOptions options = Options(300);
    options.method = method;
    const SamplingResult late =
        *SampleSurface(mesh, options, {.stop = stop.get_token(), .progress = &recorder});
    EXPECT_EQ(late.termination, Termination::kStopped);
    EXPECT_EQ(late.relative_radius, 0.0);
    const SamplingResult whole = *SampleSurface(mesh, options);
    EXPECT_NE(whole.termination, Termination::kStopped);
    EXPECT_EQ(Sorted(late.samples.positions), Sorted(whole.samples.positions));
    EXPECT_NE(late.samples.positions, whole.samples.positions);
  }
}

TEST(RunControl, TokenIsSticky) {
  std::stop_source stop;
  Recorder recorder;
  recorder.on_phase = [&](Phase phase) {
    if (phase == Phase::kFinalizing) stop.request_stop();
  };
  const RunControl run = {.stop = stop.get_token(), .progress = &recorder};
  EXPECT_TRUE(SampleSurface(shapes::Icosphere(3), Options(300), run).ok());
  EXPECT_EQ(SampleSurface(shapes::Icosphere(3), Options(300), run).status().code(),
            absl::StatusCode::kCancelled);
}

TEST(RunControl, StopFromAnotherThreadEndsALongRunSoon) {
  using Clock = std::chrono::steady_clock;
  std::stop_source stop;
  Recorder recorder;
  Clock::time_point requested;
  std::jthread stopper;
  recorder.on_alternation = [&](const AlternationReport& report) {
    if (report.alternation != 1) return;
    stopper = std::jthread([&] {
      requested = Clock::now();
      stop.request_stop();
    });
  };
  SamplingOptions options = Options(30000);
  options.max_iterations = kMaxAlternations;
  options.relative_tolerance = 1e-12;
  const SamplingResult result = *SampleSurface(shapes::Icosphere(5), options,
                                               {.stop = stop.get_token(), .progress = &recorder});
  const Clock::time_point ended = Clock::now();
  stopper.join();
  EXPECT_EQ(result.termination, Termination::kStopped);
  EXPECT_EQ(result.samples.positions.size(), 30000u);
  // The contract is 50 ms of work; the bound leaves room for busy machines and sanitizers.
  EXPECT_LT(std::chrono::duration<double>(ended - requested).count(), 5.0);
}

constexpr SamplingMethod kAllMethods[] = {
    SamplingMethod::kCcst,  SamplingMethod::kWhiteNoise,        SamplingMethod::kPoissonDisk,
    SamplingMethod::kLloyd, SamplingMethod::kSampleElimination, SamplingMethod::kCcvt};

// Runs with limits twice as long each time, from what is too short for anything, until there is a
// result; what comes before has to be an error that says so.
SamplingResult FirstResult(const TriangleMesh& mesh, SamplingOptions options) {
  for (double limit = 1e-9;; limit *= 2.0) {
    options.time_limit_seconds = limit;
    absl::StatusOr<SamplingResult> result = SampleSurface(mesh, options);
    if (result.ok()) return *std::move(result);
    EXPECT_EQ(result.status().code(), absl::StatusCode::kDeadlineExceeded) << result.status();
    EXPECT_EQ(GetErrorReason(result.status()), ErrorReason::kTimeLimitExceeded);
    EXPECT_THAT(std::string(result.status().message()), testing::HasSubstr(" while "));
  }
}

TEST(TimeLimit, TooShortForAnythingIsAnErrorOfEveryMethod) {
  for (const SamplingMethod method : kAllMethods) {
    SamplingOptions options = Options(1000);
    options.method = method;
    options.time_limit_seconds = 1e-9;
    const absl::Status status = SampleSurface(shapes::Icosphere(3), options).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
    EXPECT_EQ(GetErrorReason(status), ErrorReason::kTimeLimitExceeded);
    EXPECT_THAT(std::string(status.message()), testing::HasSubstr("allow more time"));
  }
}

TEST(TimeLimit, ReturnsAWholeIterateOfMethodsThatImprove) {
  const TriangleMesh mesh = shapes::Icosphere(4);
  for (const SamplingMethod method :
       {SamplingMethod::kCcst, SamplingMethod::kLloyd, SamplingMethod::kCcvt}) {
    SamplingOptions options = Options(10000);
    options.method = method;
    options.max_iterations = kMaxAlternations;
    options.relative_tolerance = 1e-12;
    const SamplingResult result = FirstResult(mesh, options);
    EXPECT_EQ(result.termination, Termination::kTimeLimit);
    EXPECT_EQ(result.samples.positions.size(), 10000u);
    if (method == SamplingMethod::kCcst) {
      EXPECT_EQ(FindFault(mesh, 10000, result), "");
    }
  }
}

TEST(TimeLimit, EndsNoMethodInTheMiddleOfItsOnlyStep) {
  for (const SamplingMethod method : {SamplingMethod::kWhiteNoise, SamplingMethod::kPoissonDisk,
                                      SamplingMethod::kSampleElimination}) {
    SamplingOptions options = Options(20000);
    options.method = method;
    const SamplingResult result = FirstResult(shapes::Icosphere(4), options);
    EXPECT_EQ(result.samples.positions.size(), 20000u);
    SamplingOptions whole = options;
    whole.time_limit_seconds.reset();
    EXPECT_EQ(Sorted(result.samples.positions),
              Sorted(SampleSurface(shapes::Icosphere(4), whole)->samples.positions));
  }
}

TEST(TimeLimit, CountsFromTheStart) {
  // The limit passes in the sink, before the mesh is looked at.
  Recorder recorder;
  recorder.on_phase = [](Phase phase) {
    if (phase != Phase::kPreparing) return;
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - start < std::chrono::milliseconds(3)) {
    }
  };
  SamplingOptions options = Options(100);
  options.time_limit_seconds = 2e-3;
  const absl::Status status =
      SampleSurface(shapes::Icosphere(2), options, {.stop = {}, .progress = &recorder}).status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kTimeLimitExceeded) << status;
  EXPECT_EQ(recorder.phases, std::vector<Phase>{Phase::kPreparing});
}

TEST(RunControl, HugeTimeLimitIsNone) {
  SamplingOptions options = Options(200);
  for (const double limit : {1e300, std::numeric_limits<double>::infinity()}) {
    options.time_limit_seconds = limit;
    const absl::StatusOr<SamplingResult> result = SampleSurface(shapes::Icosphere(2), options);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_NE(result->termination, Termination::kTimeLimit);
  }
}

}  // namespace
}  // namespace ccst
