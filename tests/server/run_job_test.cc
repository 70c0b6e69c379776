// How long a job may take, whatever it is doing.
#include "server/jobs/run_job.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "server/base/executor.h"
#include "server/metrics/job_observer.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

class RunJobTest : public testing::Test {
 protected:
  absl::StatusOr<JobResult> Run(const RunDependencies& run, double time_limit_seconds) {
    JobSpec spec;
    spec.share = "a";
    spec.options.sample_count = 10;
    spec.options.time_limit_seconds = time_limit_seconds;
    const auto job = std::make_shared<Job>("1", spec, run.clock, PostNow());
    EXPECT_TRUE(job->Take());
    return RunJob(*job, run, FakeInputs(decoders_, observer_));
  }

  SilentJobObserver observer_;
  Executor decoders_{1, 10};
};

// Decoders cannot be interrupted: one that is too slow is left behind.
TEST_F(RunJobTest, TimeLimitEndsAJobWhoseMeshIsStillDecoded) {
  // The decoder that is left behind has it until it ends.
  const auto decoded = std::make_shared<Gate>();
  RunDependencies run = FakeDependencies(QuickSampler());
  run.decode = [decoded](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
    decoded->Wait();
    return TriangleMesh();
  };
  const absl::Status end = Run(run, 0.01).status();
  EXPECT_EQ(end.code(), absl::StatusCode::kDeadlineExceeded) << end;
  EXPECT_EQ(GetErrorReason(end), ErrorReason::kTimeLimitExceeded);
  EXPECT_NE(end.message().find("decoded"), std::string::npos);
  decoded->Open();
}

TEST_F(RunJobTest, SamplingGetsWhatDecodingLeftOfTheTimeLimit) {
  std::optional<double> limit;
  RunDependencies run = FakeDependencies(QuickSampler());
  run.sample = [&](const TriangleMesh& mesh, const SamplingOptions& options,
                   const RunControl& control) {
    limit = options.time_limit_seconds;
    return QuickSampler()(mesh, options, control);
  };
  EXPECT_TRUE(Run(run, 1000.0).ok());
  ASSERT_TRUE(limit.has_value());
  EXPECT_LT(*limit, 1000.0);
  EXPECT_GT(*limit, 900.0);
}

}  // namespace
}  // namespace ccst::server
