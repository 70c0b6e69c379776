// The client's calls about stored meshes and jobs, against a real server.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/lib/client.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/samples_digest.h"
#include "tests/server/test_server.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using server::Gate;
using server::GatedSampler;
using server::QuickSampler;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class StoreCalls : public ::testing::Test {
 protected:
  void Start(server::SampleFunction sample = QuickSampler()) {
    server::RunDependencies run = server::RunWith(std::move(sample));
    run.digest = SamplesDigest;
    server_ = std::make_unique<server::TestServer>(std::move(run), server::ServerOptions());
    client_.emplace(*Client::Connect({.address = (*server_)->address()}));
    job_.draco = *EncodeDraco(shapes::Icosphere(4));
    job_.options.sample_count = 10;
    job_.display_name = "a sphere";
  }
  Client& client() { return *client_; }

  Gate started_;
  Gate go_;
  std::unique_ptr<server::TestServer> server_;
  std::optional<Client> client_;
  SampleJob job_;
};

TEST_F(StoreCalls, MeshIsUploadedListedDownloadedAndDeleted) {
  Start();
  std::vector<std::int64_t> sent;
  const auto mesh =
      client().UploadMesh(job_.draco, "a sphere", [&](std::int64_t now, std::int64_t total) {
        EXPECT_EQ(total, static_cast<std::int64_t>(job_.draco.size()));
        sent.push_back(now);
      });
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_FALSE(sent.empty());
  EXPECT_EQ(sent.back(), static_cast<std::int64_t>(job_.draco.size()));
  const auto listed = client().ListMeshes();
  ASSERT_TRUE(listed.ok()) << listed.status();
  ASSERT_EQ(listed->size(), 1u);
  EXPECT_EQ(listed->front().name(), mesh->name());
  EXPECT_EQ(listed->front().display_name(), "a sphere");
  EXPECT_EQ(*client().DownloadMesh(mesh->name()), job_.draco);
  EXPECT_TRUE(client().DeleteMesh(mesh->name()).ok());
  EXPECT_THAT(*client().ListMeshes(), IsEmpty());
  EXPECT_EQ(GetErrorReason(client().DownloadMesh(mesh->name()).status()), ErrorReason::kNotFound);
  EXPECT_EQ(GetErrorReason(client().DeleteMesh(mesh->name())), ErrorReason::kNotFound);
}

TEST_F(StoreCalls, MeshIsSentOnceForManyJobs) {
  Start();
  int uploads = 0;
  const auto count = [&](std::int64_t now, std::int64_t total) { uploads += now == total; };
  for (int i = 0; i < 3; ++i) {
    const auto created = client().CreateJob(job_, count);
    ASSERT_TRUE(created.ok()) << created.status();
  }
  EXPECT_EQ(uploads, 1);
}

TEST_F(StoreCalls, JobIsFoundByItsLabelsAndState) {
  Start();
  job_.labels = {{"team", "a"}};
  const std::string name = client().CreateJob(job_)->name();
  ASSERT_TRUE(client().WatchJob(name).ok());
  const auto names = [&](const std::vector<v1::Job::State>& states,
                         const std::map<std::string, std::string>& labels) {
    std::vector<std::string> found;
    const auto jobs = client().ListJobs(states, labels);
    EXPECT_TRUE(jobs.ok()) << jobs.status();
    for (const v1::Job& job : *jobs) found.push_back(job.name());
    return found;
  };
  EXPECT_THAT(names({}, {}), ElementsAre(name));
  EXPECT_THAT(names({v1::Job::STATE_SUCCEEDED}, {{"team", "a"}}), ElementsAre(name));
  EXPECT_THAT(names({v1::Job::STATE_RUNNING}, {}), IsEmpty());
  EXPECT_THAT(names({}, {{"team", "b"}}), IsEmpty());
}

TEST_F(StoreCalls, FetchGivesTheSamplesOfAnEndedJob) {
  Start();
  const std::string name = client().CreateJob(job_)->name();
  ASSERT_TRUE(client().WatchJob(name).ok());
  const auto fetched = client().FetchJob(name);
  ASSERT_TRUE(fetched.ok()) << fetched.status();
  EXPECT_EQ(fetched->job.name(), name);
  const SampleSet& samples = fetched->outcome.result.samples;
  EXPECT_THAT(samples.faces, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_EQ(samples.triangles.size(), 10u);
  EXPECT_EQ(fetched->outcome.record.samples_sha256, SamplesDigest(samples));
}

TEST_F(StoreCalls, FetchOfAJobThatRunsIsRefused) {
  Start(GatedSampler(started_, go_));
  const std::string name = client().CreateJob(job_)->name();
  started_.Wait();
  EXPECT_EQ(GetErrorReason(client().FetchJob(name).status()), ErrorReason::kJobNotEnded);
  EXPECT_EQ(GetErrorReason(client().DeleteJob(name)), ErrorReason::kJobNotEnded);
  go_.Open();
}

TEST_F(StoreCalls, CancelledJobHasNothingToFetch) {
  Start(GatedSampler(started_, go_));
  const std::string name = client().CreateJob(job_)->name();
  started_.Wait();
  const auto cancelled = client().CancelJob(name);
  ASSERT_TRUE(cancelled.ok()) << cancelled.status();
  EXPECT_EQ(cancelled->name(), name);
  EXPECT_EQ(client().WatchJob(name)->state(), v1::Job::STATE_CANCELLED);
  EXPECT_EQ(client().FetchJob(name).status().code(), absl::StatusCode::kCancelled);
}

TEST_F(StoreCalls, DeletedJobIsGone) {
  Start();
  const std::string name = client().CreateJob(job_)->name();
  ASSERT_TRUE(client().WatchJob(name).ok());
  EXPECT_TRUE(client().DeleteJob(name).ok());
  EXPECT_EQ(GetErrorReason(client().FetchJob(name).status()), ErrorReason::kNotFound);
  EXPECT_EQ(GetErrorReason(client().CancelJob(name).status()), ErrorReason::kNotFound);
}

TEST_F(StoreCalls, StopEndsCallsBeforeTheyBegin) {
  Start();
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(client().CreateJob(job_, {}, stop.get_token()).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(client().FetchJob("jobs/1", stop.get_token()).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_EQ(client().ListMeshes(stop.get_token()).status().code(), absl::StatusCode::kCancelled);
  EXPECT_THAT(*client().ListJobs(), IsEmpty());
}

}  // namespace
}  // namespace ccst
