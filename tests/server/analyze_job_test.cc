// AnalyzeJob over the wire, with the real core behind it.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/sha256.h"
#include "core/io/draco_mesh.h"
#include "server/app/system.h"
#include "tests/server/test_server.h"
#include "tests/support/shapes.h"

namespace ccst::server {
namespace {

using Stub = v1::SamplingService::Stub;

v1::SampleRequest TorusRequest(v1::SamplingMethod method) {
  v1::SampleRequest request = Request(1000);
  request.mutable_inline_mesh()->set_data(*EncodeDraco(shapes::Torus(1.0, 0.4, 25, 20)));
  request.mutable_options()->set_method(method);
  return request;
}

std::string RunJob(TestServer& server, v1::SamplingMethod method) {
  const Answer answer = Sample(server.sampling(), TorusRequest(method));
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
  return answer.events.back().snapshot().name();
}

grpc::Status Analyze(TestServer& server, grpc::ClientContext& context, const std::string& job,
                     v1::AnalyzeJobResponse& response) {
  v1::AnalyzeJobRequest request;
  request.set_name(job);
  return server.sampling().AnalyzeJob(&context, request, &response);
}

v1::AnalyzeJobResponse Analyze(TestServer& server, const std::string& job) {
  grpc::ClientContext context;
  v1::AnalyzeJobResponse response;
  const grpc::Status status = Analyze(server, context, job, response);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return response;
}

// A real server whose decoder, from the second call on, waits for `go`.
class BlockedDecoder {
 public:
  RunDependencies Run() {
    RunDependencies run = RealRunDependencies(SystemClock(), {});
    run.decode = [this, decode = run.decode](std::span<const char> bytes,
                                             const MeshLimits& limits) {
      if (calls_++ > 0) {
        blocked_.Open();
        go_.Wait();
      }
      return decode(bytes, limits);
    };
    return run;
  }
  void WaitUntilBlocked() { blocked_.Wait(); }
  void Go() { go_.Open(); }

 private:
  std::atomic<int> calls_ = 0;
  Gate blocked_;
  Gate go_;
};

TEST(AnalyzeJob, EveryMethodHasCurvesOfTheSameSurface) {
  TestServer server(RealRunDependencies(SystemClock(), {}), {});
  const v1::AnalyzeJobResponse ccst = Analyze(server, RunJob(server, v1::SAMPLING_METHOD_CCST));
  const v1::AnalyzeJobResponse poisson =
      Analyze(server, RunJob(server, v1::SAMPLING_METHOD_POISSON_DISK));
  const v1::AnalyzeJobResponse white =
      Analyze(server, RunJob(server, v1::SAMPLING_METHOD_WHITE_NOISE));
  for (const v1::AnalyzeJobResponse* response : {&ccst, &poisson, &white}) {
    EXPECT_GT(response->radial_mean().x_size(), 0);
    EXPECT_GT(response->anisotropy().x_size(), 0);
    EXPECT_GT(response->power_spectrum().x_size(), 0);
    EXPECT_TRUE(response->has_oscillation());
  }
  EXPECT_GT(ccst.effective_nyquist(), poisson.effective_nyquist());
  EXPECT_GT(poisson.effective_nyquist(), 0.5);
  EXPECT_LT(white.effective_nyquist(), 0.1);
}

TEST(AnalyzeJob, AngleHistogramHoldsAllAnglesInRadians) {
  TestServer server(RealRunDependencies(SystemClock(), {}), {});
  const v1::AnalyzeJobResponse response = Analyze(server, RunJob(server, v1::SAMPLING_METHOD_CCST));
  const auto& x = response.angle_histogram().x();
  const auto& y = response.angle_histogram().y();
  ASSERT_EQ(x.size(), y.size());
  ASSERT_GT(x.size(), 1);
  EXPECT_NEAR(std::accumulate(y.begin(), y.end(), 0.0), 1.0, 1e-12);
  const double width = x[1] - x[0];
  EXPECT_NEAR(x[0], 0.5 * width, 1e-12);
  EXPECT_NEAR(x[x.size() - 1], std::numbers::pi - 0.5 * width, 1e-12);
  const auto first = std::find_if(y.begin(), y.end(), [](double share) { return share > 0.0; });
  EXPECT_NEAR(x[static_cast<int>(first - y.begin())], response.min_angle_radians(), 0.5 * width);
}

TEST(AnalyzeJob, PointsHaveNoFiguresOfTriangles) {
  TestServer server(RealRunDependencies(SystemClock(), {}), {});
  const v1::AnalyzeJobResponse response =
      Analyze(server, RunJob(server, v1::SAMPLING_METHOD_WHITE_NOISE));
  EXPECT_FALSE(response.has_angle_histogram());
  EXPECT_FALSE(response.has_min_angle_radians());
  EXPECT_FALSE(response.has_capacity_cv());
  EXPECT_FALSE(response.has_voronoi_cv());
}

TEST(AnalyzeJob, AnswersAreTheSameBitsForAnyThreads) {
  std::vector<std::string> answers;
  for (const int threads : {1, 4}) {
    ServerOptions options;
    options.threads_per_job = threads;
    TestServer server(RealRunDependencies(SystemClock(), {}), options);
    answers.push_back(
        Analyze(server, RunJob(server, v1::SAMPLING_METHOD_CCST)).SerializeAsString());
  }
  EXPECT_EQ(answers[0], answers[1]);
}

TEST(AnalyzeJob, PassedDeadlineEndsTheWork) {
  BlockedDecoder decoder;
  TestServer server(decoder.Run(), {});
  const std::string job = RunJob(server, v1::SAMPLING_METHOD_POISSON_DISK);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(300));
  v1::AnalyzeJobResponse response;
  EXPECT_EQ(Analyze(server, context, job, response).error_code(),
            grpc::StatusCode::DEADLINE_EXCEEDED);
  // The line is written when the thread is free again, with the decoder still at work.
  const auto is_ended = [&] {
    const std::vector<std::string> lines = server.LogLines();
    return std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find(" AnalyzeJob CANCELLED ") != std::string::npos;
    });
  };
  while (!is_ended()) std::this_thread::yield();
  decoder.Go();
  EXPECT_GT(Analyze(server, job).power_spectrum().x_size(), 0);
}

// Calls of AnalyzeJob that are under way together.
class ManyCalls {
 public:
  ManyCalls(Stub& stub, const std::string& job, int count) : calls_(count) {
    for (Call& call : calls_) {
      call.request.set_name(job);
      stub.async()->AnalyzeJob(&call.context, &call.request, &call.response,
                               [this, &call](grpc::Status status) {
                                 const std::lock_guard lock(mutex_);
                                 call.status = std::move(status);
                                 ++ended_;
                                 changed_.notify_all();
                               });
    }
  }
  void CancelAll() {
    for (Call& call : calls_) call.context.TryCancel();
  }
  void WaitForEnds(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ >= count; });
  }
  int CountOf(grpc::StatusCode code) const {
    return static_cast<int>(std::count_if(calls_.begin(), calls_.end(), [&](const Call& call) {
      return call.status.error_code() == code;
    }));
  }

 private:
  struct Call {
    grpc::ClientContext context;
    v1::AnalyzeJobRequest request;
    v1::AnalyzeJobResponse response;
    grpc::Status status;
  };
  std::mutex mutex_;
  std::condition_variable changed_;
  int ended_ = 0;
  std::vector<Call> calls_;
};

TEST(AnalyzeJob, ManyCallsAreBoundedAndHoldUpNobody) {
  constexpr int kCalls = 100;
  // Two are computed, 64 wait.
  constexpr int kTaken = 66;
  BlockedDecoder decoder;
  TestServer server(decoder.Run(), {});
  const std::string job = RunJob(server, v1::SAMPLING_METHOD_POISSON_DISK);
  ManyCalls calls(server.sampling(), job, kCalls);
  calls.WaitForEnds(kCalls - kTaken);
  decoder.WaitUntilBlocked();
  grpc::ClientContext get_context;
  v1::GetJobRequest get;
  get.set_name(job);
  v1::GetJobResponse got;
  EXPECT_TRUE(server.sampling().GetJob(&get_context, get, &got).ok());
  const std::string bytes = *EncodeDraco(shapes::Cube());
  grpc::ClientContext create_context;
  v1::CreateMeshRequest create;
  create.mutable_header()->mutable_digest()->set_sha256(Sha256Of(bytes));
  create.mutable_header()->mutable_digest()->set_size_bytes(
      static_cast<std::int64_t>(bytes.size()));
  create.mutable_header()->set_format(v1::MESH_FORMAT_DRACO);
  create.set_data(bytes);
  v1::CreateMeshResponse created;
  EXPECT_TRUE(server.meshes().CreateMesh(&create_context, create, &created).ok());
  calls.CancelAll();
  calls.WaitForEnds(kCalls);
  decoder.Go();
  // Two fewer where all came before the threads began.
  const int refused = calls.CountOf(grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_GE(refused, kCalls - kTaken);
  EXPECT_LE(refused, kCalls - kTaken + 2);
  EXPECT_EQ(calls.CountOf(grpc::StatusCode::CANCELLED), kCalls - refused);
}

}  // namespace
}  // namespace ccst::server
