#include "client/lib/client.h"

#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "ccst/v1/error.pb.h"
#include "client/lib/grpc_error.h"
#include "client/lib/outcome.h"
#include "core/base/status.h"
#include "core/io/samples_digest.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/samples.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Writer = grpc::ServerWriter<v1::SampleResponse>;

constexpr int kCount = 5;

// Answers as each test says.
class FakeService : public v1::SamplingService::Service {
 public:
  using Handler =
      std::function<grpc::Status(grpc::ServerContext&, const v1::SampleRequest&, Writer&)>;

  grpc::Status Sample(grpc::ServerContext* context, const v1::SampleRequest* request,
                      Writer* writer) override {
    ++calls;
    // A test may set the next handler while a call that the client gave up is still in this one.
    const Handler current = handler;
    return current(*context, *request, *writer);
  }

  Handler handler;
  std::atomic<int> calls = 0;
};

SampleSet RightSamples() {
  SampleSet samples;
  for (int i = 0; i < kCount; ++i) {
    samples.faces.push_back(i);
    samples.barycentrics.emplace_back(0.1 * i, 0.3);
    samples.positions.emplace_back(9, 9, 9);
    samples.normals.emplace_back(0.0, 0.1, 1.0);
  }
  samples.triangles = {{0, 1, 2}, {2, 3, 4}};
  return samples;
}

v1::SampleResponse Snapshot(v1::Job::State state) {
  v1::SampleResponse message;
  message.mutable_snapshot()->set_name("jobs/7");
  message.mutable_snapshot()->set_state(state);
  return message;
}

// A whole answer; tests change it to make it wrong.
std::vector<v1::SampleResponse> RightAnswer(const SampleSet& samples) {
  std::vector<v1::SampleResponse> answer = {Snapshot(v1::Job::STATE_RUNNING)};
  for (int i = 0; i < 3; ++i) {
    AlternationReport report;
    report.alternation = i;
    report.energy = 1.0 / (i + 1);
    *answer.emplace_back().mutable_progress() = ToProto(report, Phase::kRelaxing);
  }
  *answer.emplace_back().mutable_samples() = SampleChunkToProto(samples, 0, 3);
  *answer.emplace_back().mutable_samples() = SampleChunkToProto(samples, 3, kCount - 3);
  *answer.emplace_back().mutable_sample_mesh() = SampleMeshChunkToProto(samples, 0, 2);
  SamplingResult result;
  result.samples = samples;
  result.termination = Termination::kConverged;
  result.capacity_cv = 0.02;
  v1::SampleResponse last = Snapshot(v1::Job::STATE_SUCCEEDED);
  RunRecord record;
  record.samples_sha256 = SamplesDigest(samples);
  *last.mutable_snapshot()->mutable_result() = ToProto(result, record);
  answer.push_back(last);
  return answer;
}

FakeService::Handler Send(std::vector<v1::SampleResponse> messages,
                          const grpc::Status& status = grpc::Status::OK) {
  return [messages, status](grpc::ServerContext&, const v1::SampleRequest&, Writer& writer) {
    for (const v1::SampleResponse& message : messages) writer.Write(message);
    return status;
  };
}

class ClientTest : public ::testing::Test {
 protected:
  ClientTest() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
    job_.mesh = shapes::Icosphere(0);
    job_.draco = "bytes";
    job_.origin = {100, 0, 0};
    job_.options.sample_count = kCount;
  }
  ~ClientTest() override { server_->Shutdown(); }

  absl::StatusOr<SampleOutcome> Sample(const SampleCallbacks& callbacks = {},
                                       std::stop_token stop = {}) {
    return Client::Connect({.address = address_})->Sample(job_, callbacks, stop);
  }

  FakeService service_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  SampleJob job_;
};

TEST_F(ClientTest, PutsTheAnswerTogether) {
  const SampleSet samples = RightSamples();
  v1::SampleRequest seen;
  service_.handler = [&](grpc::ServerContext& context, const v1::SampleRequest& request,
                         Writer& writer) {
    seen = request;
    return Send(RightAnswer(samples))(context, request, writer);
  };
  std::vector<int> alternations;
  std::vector<int> states;
  SampleCallbacks callbacks;
  callbacks.on_progress = [&](const AlternationReport& r) {
    alternations.push_back(r.alternation);
  };
  callbacks.on_snapshot = [&](const v1::Job& job) { states.push_back(job.state()); };
  const auto outcome = Sample(callbacks);
  ASSERT_TRUE(outcome.ok()) << outcome.status();

  EXPECT_EQ(seen.inline_mesh().data(), "bytes");
  EXPECT_EQ(seen.inline_mesh().origin().x(), 100.0);
  EXPECT_EQ(seen.options().sample_count(), kCount);
  EXPECT_THAT(alternations, ElementsAre(0, 1, 2));
  EXPECT_THAT(states, ElementsAre(v1::Job::STATE_RUNNING, v1::Job::STATE_SUCCEEDED));
  EXPECT_EQ(outcome->job_name, "jobs/7");
  EXPECT_EQ(outcome->result.capacity_cv, 0.02);
  EXPECT_EQ(outcome->result.samples.faces, samples.faces);
  EXPECT_EQ(outcome->result.samples.triangles, samples.triangles);
  EXPECT_EQ(outcome->record.samples_sha256, SamplesDigest(samples));
}

TEST_F(ClientTest, PlacesSamplesByTheirBarycentrics) {
  service_.handler = Send(RightAnswer(RightSamples()));
  const auto outcome = Sample();
  ASSERT_TRUE(outcome.ok()) << outcome.status();
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3i& f = job_.mesh.faces[i];
    const Eigen::Vector3d expected = 0.1 * i * job_.mesh.positions[f[0]] +
                                     0.3 * job_.mesh.positions[f[1]] +
                                     (1.0 - 0.1 * i - 0.3) * job_.mesh.positions[f[2]];
    EXPECT_LT((outcome->result.samples.positions[i] - Eigen::Vector3d(100, 0, 0) - expected).norm(),
              1e-12);
    EXPECT_EQ(outcome->result.samples.normals[i].y(), static_cast<double>(0.1f));
  }
}

TEST_F(ClientTest, RefusesAnswersThatContradictThemselves) {
  const SampleSet right = RightSamples();
  std::vector<std::pair<std::string, std::vector<v1::SampleResponse>>> wrong;
  const auto add = [&](const std::string& expected, const auto& change) {
    auto answer = RightAnswer(right);
    change(answer);
    wrong.emplace_back(expected, answer);
  };
  add("digest", [](auto& a) { a[4].mutable_samples()->set_barycentrics(0, 0.125); });
  add("start at", [](auto& a) { a[5].mutable_samples()->set_start_index(4); });
  add("3 samples, asked for 5", [](auto& a) { a.erase(a.begin() + 5, a.begin() + 7); });
  add("names sample 3 of 3", [](auto& a) { a.erase(a.begin() + 5); });
  add("more than the 5", [](auto& a) { a.insert(a.begin() + 6, a[4]); });
  add("triangle", [](auto& a) { a[6].mutable_sample_mesh()->set_vertex_indices(1, 5); });
  add("0 triangles, announced 2", [](auto& a) { a.erase(a.begin() + 6); });
  add("ended before", [](auto& a) { a.pop_back(); });
  for (const auto& [expected, answer] : wrong) {
    service_.handler = Send(answer);
    const auto outcome = Sample();
    EXPECT_EQ(outcome.status().code(), absl::StatusCode::kDataLoss) << expected;
    EXPECT_THAT(std::string(outcome.status().message()), HasSubstr(expected));
  }
}

TEST_F(ClientTest, RefusesHostsOutsideTheMesh) {
  for (const std::int32_t face : {-1, 20}) {
    SampleSet samples = RightSamples();
    samples.faces[2] = face;
    service_.handler = Send(RightAnswer(samples));
    const auto outcome = Sample();
    EXPECT_EQ(outcome.status().code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(std::string(outcome.status().message()), HasSubstr("sample 2"));
  }
  SampleSet samples = RightSamples();
  samples.barycentrics[1] = {0.7, 0.7};
  service_.handler = Send(RightAnswer(samples));
  EXPECT_EQ(Sample().status().code(), absl::StatusCode::kDataLoss);
}

TEST_F(ClientTest, DecodesErrorDetails) {
  absl::Status sent = MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                                "64 jobs wait already");
  v1::RetryAdvice advice;
  *advice.mutable_retry_delay() = DurationToProto(2.0);
  SetDetail(advice, sent);
  const v1::Status details = ToProto(sent);
  service_.handler = Send({}, grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, details.message(),
                                           details.SerializeAsString()));
  const absl::Status status = Sample().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kQueueFull);
  EXPECT_EQ(status.message(), "64 jobs wait already");
  EXPECT_EQ(RetryDelaySeconds(status), 2.0);
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(ClientTest, ReportsTheErrorOfAFailedJob) {
  v1::SampleResponse failed = Snapshot(v1::Job::STATE_FAILED);
  *failed.mutable_snapshot()->mutable_error() =
      ToProto(MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory, "4 GiB"));
  service_.handler = Send({Snapshot(v1::Job::STATE_RUNNING), failed});
  const absl::Status status = Sample().status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kOutOfMemory);
  EXPECT_EQ(status.message(), "4 GiB");
}

TEST_F(ClientTest, RepeatsACallTheServerWasNotThereFor) {
  service_.handler = [this](grpc::ServerContext& context, const v1::SampleRequest& request,
                            Writer& writer) {
    if (service_.calls == 1) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
    return Send(RightAnswer(RightSamples()))(context, request, writer);
  };
  EXPECT_TRUE(Sample().ok());
  EXPECT_EQ(service_.calls, 2);
}

TEST_F(ClientTest, GivesUpAfterAFewAttempts) {
  service_.handler = Send({}, grpc::Status(grpc::StatusCode::UNAVAILABLE, "away"));
  EXPECT_EQ(Sample().status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(service_.calls, 3);
}

TEST_F(ClientTest, DoesNotRepeatAStreamThatHadBegun) {
  for (const auto code :
       {grpc::StatusCode::UNAVAILABLE, grpc::StatusCode::UNKNOWN, grpc::StatusCode::INTERNAL}) {
    service_.calls = 0;
    service_.handler = Send({Snapshot(v1::Job::STATE_RUNNING)}, grpc::Status(code, "gone"));
    const absl::Status status = Sample().status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(status.message()), HasSubstr("lost"));
    EXPECT_EQ(service_.calls, 1);
  }
}

TEST_F(ClientTest, OtherErrorsAreNotRepeated) {
  service_.handler = Send({}, grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "no"));
  EXPECT_EQ(Sample().status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(ClientTest, StopCancelsTheCall) {
  std::stop_source stop;
  std::atomic<bool> seen = false;
  service_.handler = [&](grpc::ServerContext& context, const v1::SampleRequest&, Writer& writer) {
    // Writes until the cancel arrives, which makes writing fail.
    while (writer.Write(Snapshot(v1::Job::STATE_RUNNING)) && !context.IsCancelled()) {
    }
    seen = true;
    return grpc::Status::CANCELLED;
  };
  SampleCallbacks callbacks;
  callbacks.on_snapshot = [&](const v1::Job&) { stop.request_stop(); };
  const absl::Status status = Sample(callbacks, stop.get_token()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
  server_->Shutdown();
  EXPECT_TRUE(seen);
}

TEST_F(ClientTest, StopBeforeTheCallSendsNothing) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(Sample({}, stop.get_token()).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(service_.calls, 0);
}

TEST_F(ClientTest, StopEndsTheWaitBetweenAttempts) {
  std::stop_source stop;
  absl::Status draining = MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining, "bye");
  v1::RetryAdvice advice;
  *advice.mutable_retry_delay() = DurationToProto(3600.0);
  SetDetail(advice, draining);
  const v1::Status details = ToProto(draining);
  service_.handler = [&](grpc::ServerContext&, const v1::SampleRequest&, Writer&) {
    stop.request_stop();
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "bye", details.SerializeAsString());
  };
  EXPECT_EQ(Sample({}, stop.get_token()).status().code(), absl::StatusCode::kCancelled);
}

TEST(Client, SaysThatNoServerIsThere) {
  // Port 1 of the loopback interface is reserved and refuses connections.
  Client client = *Client::Connect({.address = "127.0.0.1:1"});
  SampleJob job;
  job.options.sample_count = 4;
  EXPECT_EQ(client.Sample(job).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(client.GetServerInfo().status().code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace ccst
