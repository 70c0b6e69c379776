#include "server/rpc/job_messages.h"

#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "google/protobuf/descriptor.h"
#include "tests/server/fakes.h"

namespace ccst::server {
namespace {

TEST(JobMessages, EveryFieldIsFilled) {
  JobSpec spec;
  spec.display_name = "bunny";
  spec.labels = {{"team", "scatter"}};
  spec.mesh_sha256 = "00";
  spec.texture_sha256 = "11";
  spec.options.sample_count = 10;
  spec.origin = Eigen::Vector3d(1, 2, 3);
  JobView view;
  view.cached = true;
  view.state = JobState::kSucceeded;
  view.queue_position = 3;
  view.phase = Phase::kRelaxing;
  view.last_report = AlternationReport();
  view.error = absl::InternalError("bug");
  auto result = std::make_shared<JobResult>();
  result->sample_count = 10;
  view.result = std::move(result);
  view.create_time = absl::FromUnixSeconds(1'000'000'000) + absl::Nanoseconds(7);
  view.start_time = view.create_time;
  view.end_time = view.create_time;
  view.expire_time = view.create_time;
  const v1::Job job = ToProto("1", spec, view);
  // A field that is added to Job and not to ToProto fails here.
  std::vector<const google::protobuf::FieldDescriptor*> set;
  job.GetReflection()->ListFields(job, &set);
  EXPECT_EQ(static_cast<int>(set.size()), v1::Job::descriptor()->field_count());
  EXPECT_EQ(job.create_time().seconds(), 1'000'000'000);
  EXPECT_EQ(job.create_time().nanos(), 7);
  EXPECT_EQ(job.origin().z(), 3.0);
  EXPECT_EQ(job.result().sample_count(), 10);
}

TEST(JobMessages, EveryStateHasItsName) {
  const auto* states = v1::Job::State_descriptor();
  for (int i = 1; i < states->value_count(); ++i) {
    EXPECT_EQ(ToProto(static_cast<JobState>(i - 1)), states->value(i)->number());
  }
}

}  // namespace
}  // namespace ccst::server
