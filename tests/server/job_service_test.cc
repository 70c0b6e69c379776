// The life of a job over the wire.
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/sha256.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

constexpr char kMesh[] = "mesh";

class JobService : public testing::Test {
 protected:
  void Start(SampleFunction sample, ServerOptions options = {}) {
    server_ = std::make_unique<TestServer>(std::move(sample), options);
    // The job of an inline mesh leaves the mesh to others no longer than it is kept itself; a
    // stored mesh would have to be a real one.
    v1::SampleRequest request = Request();
    request.mutable_inline_mesh()->set_data(kMesh);
    mesh_job_ = Sample(server_->sampling(), request).events.back().snapshot().name();
  }

  template <typename Method, typename Request, typename Response>
  grpc::Status Call(Method method, const Request& request, Response& response) {
    grpc::ClientContext context;
    return (server_->sampling().*method)(&context, request, &response);
  }

  std::string mesh_job_;
  std::unique_ptr<TestServer> server_;
};

std::vector<v1::WatchJobResponse> Watch(v1::SamplingService::Stub& stub,
                                        const v1::WatchJobRequest& request) {
  grpc::ClientContext context;
  const auto reader = stub.WatchJob(&context, request);
  std::vector<v1::WatchJobResponse> events;
  v1::WatchJobResponse event;
  while (reader->Read(&event)) events.push_back(event);
  EXPECT_TRUE(reader->Finish().ok());
  return events;
}

std::vector<std::int64_t> ProgressOf(const std::vector<v1::WatchJobResponse>& events) {
  std::vector<std::int64_t> sequences;
  for (const auto& event : events) {
    if (event.has_progress()) sequences.push_back(event.sequence());
  }
  return sequences;
}

TEST_F(JobService, EndedJobReplaysItsHistoryFromAnySequence) {
  Start(QuickSampler(5));
  v1::WatchJobRequest request;
  request.set_name(mesh_job_);
  const auto all = Watch(server_->sampling(), request);
  EXPECT_TRUE(all.front().has_snapshot());
  EXPECT_EQ(ProgressOf(all), (std::vector<std::int64_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(all.back().sequence(), 6);
  EXPECT_EQ(all.back().snapshot().state(), v1::Job::STATE_SUCCEEDED);
  request.set_after_sequence(3);
  EXPECT_EQ(ProgressOf(Watch(server_->sampling(), request)), (std::vector<std::int64_t>{4, 5}));
  request.set_after_sequence(-1);
  grpc::ClientContext context;
  const auto refused = server_->sampling().WatchJob(&context, request);
  v1::WatchJobResponse event;
  EXPECT_FALSE(refused->Read(&event));
  EXPECT_EQ(refused->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(JobService, SequencesBeyondTheHistoryLeadToItsEnd) {
  Start(QuickSampler(5));
  v1::WatchJobRequest request;
  request.set_name(mesh_job_);
  for (const std::int64_t after :
       {std::int64_t{5}, std::int64_t{6}, std::int64_t{7}, std::int64_t{1'000'000},
        std::int64_t{1} << 62, std::numeric_limits<std::int64_t>::max()}) {
    request.set_after_sequence(after);
    const auto events = Watch(server_->sampling(), request);
    EXPECT_TRUE(events.front().has_snapshot());
    EXPECT_TRUE(ProgressOf(events).empty());
    EXPECT_EQ(events.back().sequence(), 6) << after;
    EXPECT_EQ(events.back().snapshot().state(), v1::Job::STATE_SUCCEEDED);
  }
}

// A line of the log names a job when there is one, and nothing else that a caller sent.
TEST_F(JobService, NamesOfNoJobStayOutOfTheLog) {
  Start(QuickSampler());
  using Jobs = v1::SamplingService::Stub;
  const auto call_all = [&](const std::string& name) {
    const auto unary = [&](auto method, auto request, auto response) {
      request.set_name(name);
      Call(method, request, response);
    };
    const auto stream = [&](auto method, auto request, auto response) {
      request.set_name(name);
      grpc::ClientContext context;
      const auto reader = (server_->sampling().*method)(&context, request);
      while (reader->Read(&response)) continue;
      reader->Finish();
    };
    unary(&Jobs::GetJob, v1::GetJobRequest(), v1::GetJobResponse());
    unary(&Jobs::CancelJob, v1::CancelJobRequest(), v1::CancelJobResponse());
    unary(&Jobs::AnalyzeJob, v1::AnalyzeJobRequest(), v1::AnalyzeJobResponse());
    stream(&Jobs::WatchJob, v1::WatchJobRequest(), v1::WatchJobResponse());
    stream(&Jobs::ReadSamples, v1::ReadSamplesRequest(), v1::ReadSamplesResponse());
    stream(&Jobs::ReadSampleMesh, v1::ReadSampleMeshRequest(), v1::ReadSampleMeshResponse());
    unary(&Jobs::DeleteJob, v1::DeleteJobRequest(), v1::DeleteJobResponse());
  };
  for (const char* name : {"jobs/forged\n1970-01-01T00:00:00.000Z draining", "jobs/forged\x1b[2J",
                           "jobs/../../forged", "forged", "meshes/forged"}) {
    call_all(name);
  }
  call_all(mesh_job_);
  (*server_)->Drain();  // Every call is done, and has its line.
  int named = 0;
  for (const std::string& line : server_->LogLines()) {
    EXPECT_EQ(line.find("forged"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    named += line.find(mesh_job_) != std::string::npos;
  }
  EXPECT_EQ(named, 8);  // With the call that made it.
}

TEST_F(JobService, SamplesAreReadAgainFromAnyIndex) {
  Start(QuickSampler());
  v1::ReadSamplesRequest request;
  request.set_name(mesh_job_);
  for (const std::int64_t start : {0, 7, 10}) {
    request.set_start_index(start);
    grpc::ClientContext context;
    const auto reader = server_->sampling().ReadSamples(&context, request);
    v1::ReadSamplesResponse chunk;
    std::int64_t next = start;
    while (reader->Read(&chunk)) {
      EXPECT_EQ(chunk.samples().start_index(), next);
      for (const int face : chunk.samples().face_indices()) EXPECT_EQ(face, next++);
    }
    EXPECT_TRUE(reader->Finish().ok());
    EXPECT_EQ(next, 10);
  }
  request.set_start_index(11);
  grpc::ClientContext context;
  const auto reader = server_->sampling().ReadSamples(&context, request);
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(JobService, ListedCountedAndDeleted) {
  Start(QuickSampler());
  v1::SampleRequest labelled = Request();
  (*labelled.mutable_labels())["team"] = "a";
  Sample(server_->sampling(), labelled);
  v1::ListJobsRequest list;
  v1::ListJobsResponse page;
  ASSERT_TRUE(Call(&v1::SamplingService::Stub::ListJobs, list, page).ok());
  EXPECT_EQ(page.jobs_size(), 2);
  (*list.mutable_labels())["team"] = "a";
  ASSERT_TRUE(Call(&v1::SamplingService::Stub::ListJobs, list, page).ok());
  ASSERT_EQ(page.jobs_size(), 1);
  EXPECT_EQ(page.jobs(0).labels().at("team"), "a");
  v1::DeleteJobRequest remove;
  remove.set_name(mesh_job_);
  v1::DeleteJobResponse removed;
  ASSERT_TRUE(Call(&v1::SamplingService::Stub::DeleteJob, remove, removed).ok());
  v1::GetJobRequest get;
  get.set_name(mesh_job_);
  v1::GetJobResponse got;
  EXPECT_EQ(Call(&v1::SamplingService::Stub::GetJob, get, got).error_code(),
            grpc::StatusCode::NOT_FOUND);
}

TEST_F(JobService, MissingMeshSaysWhichToUpload) {
  Start(QuickSampler());
  v1::CreateJobRequest request;
  request.mutable_spec()->set_mesh("meshes/" + Sha256Of("nothing"));
  request.mutable_spec()->mutable_options()->set_sample_count(10);
  v1::CreateJobResponse response;
  const grpc::Status status = Call(&v1::SamplingService::Stub::CreateJob, request, response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  v1::Status details;
  ASSERT_TRUE(details.ParseFromString(status.error_details()));
  v1::MissingMeshes missing;
  ASSERT_TRUE(Unpack(details, missing));
  EXPECT_EQ(missing.meshes(0), request.spec().mesh());
}

TEST_F(JobService, WrongNamesAreInvalidAndUnknownOnesNotFound) {
  Start(QuickSampler());
  v1::GetJobResponse response;
  for (const auto& [name, code] :
       {std::pair(std::string("meshes/1"), grpc::StatusCode::INVALID_ARGUMENT),
        std::pair(std::string("jobs/"), grpc::StatusCode::INVALID_ARGUMENT),
        std::pair(std::string("jobs/").append(100, 'x'), grpc::StatusCode::INVALID_ARGUMENT),
        std::pair(std::string("jobs/../../etc/passwd"), grpc::StatusCode::NOT_FOUND)}) {
    v1::GetJobRequest request;
    request.set_name(name);
    EXPECT_EQ(Call(&v1::SamplingService::Stub::GetJob, request, response).error_code(), code)
        << name;
  }
}

TEST_F(JobService, CancelIsNoErrorOnAnEndedJob) {
  Start(QuickSampler());
  v1::CancelJobRequest request;
  request.set_name(mesh_job_);
  v1::CancelJobResponse response;
  ASSERT_TRUE(Call(&v1::SamplingService::Stub::CancelJob, request, response).ok());
  EXPECT_EQ(response.job().state(), v1::Job::STATE_SUCCEEDED);
}

TEST_F(JobService, RunningJobHasNoSamplesYetAndSaysSo) {
  Gate started;
  Gate go;
  server_ = std::make_unique<TestServer>(GatedSampler(started, go));
  grpc::ClientContext context;
  const auto stream = server_->sampling().Sample(&context, Request());
  v1::SampleResponse event;
  ASSERT_TRUE(stream->Read(&event));
  started.Wait();
  v1::ReadSamplesRequest request;
  request.set_name(event.snapshot().name());
  grpc::ClientContext read_context;
  const auto reader = server_->sampling().ReadSamples(&read_context, request);
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  v1::DeleteJobRequest remove;
  remove.set_name(request.name());
  v1::DeleteJobResponse removed;
  EXPECT_EQ(Call(&v1::SamplingService::Stub::DeleteJob, remove, removed).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
  go.Open();
  while (stream->Read(&event)) {
  }
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(JobService, EqualRequestIsAnsweredFromTheCacheWithItsHistory) {
  Start(QuickSampler(4));
  v1::SampleRequest request = Request();
  request.set_skip_cache_lookup(false);
  const Answer answer = Sample(server_->sampling(), request);
  ASSERT_TRUE(answer.status.ok());
  EXPECT_TRUE(answer.events.back().snapshot().result_cached());
  EXPECT_NE(answer.events.back().snapshot().name(), mesh_job_);
  int progress = 0;
  int samples = 0;
  for (const auto& event : answer.events) {
    progress += event.has_progress() ? 1 : 0;
    samples += event.samples().face_indices_size();
  }
  EXPECT_EQ(progress, 4);
  EXPECT_EQ(samples, 10);
}

}  // namespace
}  // namespace ccst::server
