#include "server/rpc/job_events.h"

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "server/jobs/job.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

// A job that nobody runs: what happens to it is told here.
std::shared_ptr<Job> NewJob(const RunDependencies& dependencies) {
  JobSpec spec;
  spec.mesh_sha256 = "mesh";
  spec.options.sample_count = 10;
  return std::make_shared<Job>("1", spec, dependencies.clock, PostNow());
}

void Report(Job& job, int alternation) {
  const std::vector<Eigen::Vector3d> positions(10, Eigen::Vector3d::Zero());
  AlternationReport report;
  report.alternation = alternation;
  report.positions = positions;
  job.AddReport(report);
}

// Everything there is to say, checking before each that it was announced.
std::vector<JobEvents::Kind> Rest(JobEvents& events) {
  std::vector<JobEvents::Kind> kinds;
  while (true) {
    const bool announced = events.HasNext();
    const JobEvents::Kind kind = events.Next();
    EXPECT_EQ(announced, kind != JobEvents::Kind::kNothing);
    if (kind == JobEvents::Kind::kNothing) return kinds;
    kinds.push_back(kind);
    if (kind == JobEvents::Kind::kEnd) return kinds;
  }
}

TEST(JobEvents, HasNextAnnouncesEveryKind) {
  using Kind = JobEvents::Kind;
  const RunDependencies dependencies = FakeDependencies(QuickSampler(1));
  const auto job = NewJob(dependencies);
  ASSERT_TRUE(job->AddWatcher([] {}, 5, 10).has_value());  // Asks for previews.
  JobEvents events(job, 0, 5);
  EXPECT_EQ(Rest(events), std::vector<Kind>{Kind::kSnapshot});
  ASSERT_TRUE(job->Take());
  EXPECT_EQ(Rest(events), std::vector<Kind>{Kind::kSnapshot});
  Report(*job, 0);
  Report(*job, 1);
  EXPECT_EQ(Rest(events), (std::vector<Kind>{Kind::kProgress, Kind::kProgress, Kind::kPreview}));
  Report(*job, 2);
  job->Publish(job->Seal(absl::InternalError("broken")));
  EXPECT_EQ(Rest(events), (std::vector<Kind>{Kind::kProgress, Kind::kEnd}));
  EXPECT_TRUE(events.HasNext());
}

TEST(JobEvents, PreviewsThatWereNotAskedForAreNoNews) {
  const RunDependencies dependencies = FakeDependencies(QuickSampler(1));
  const auto job = NewJob(dependencies);
  ASSERT_TRUE(job->AddWatcher([] {}, 5, 10).has_value());
  ASSERT_TRUE(job->Take());
  JobEvents events(job, 1, 0);
  Report(*job, 0);
  EXPECT_EQ(Rest(events), std::vector<JobEvents::Kind>{JobEvents::Kind::kSnapshot});
  EXPECT_FALSE(events.HasNext());
}

}  // namespace
}  // namespace ccst::server
