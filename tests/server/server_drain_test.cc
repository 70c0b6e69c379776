#include <array>
#include <future>
#include <memory>
#include <vector>

#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include "grpc/health/v1/health.grpc.pb.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;

HealthCheckResponse::ServingStatus Check(TestServer& server, const std::string& service) {
  const auto stub = grpc::health::v1::Health::NewStub(server.channel());
  grpc::ClientContext context;
  HealthCheckRequest request;
  request.set_service(service);
  HealthCheckResponse response;
  const grpc::Status status = stub->Check(&context, request, &response);
  return status.ok() ? response.status() : HealthCheckResponse::SERVICE_UNKNOWN;
}

TEST(Health, IsKnownForTheServerAndEveryService) {
  TestServer server(QuickSampler());
  for (const char* name : {"", "ccst.v1.SamplingService", "ccst.v1.ServerInfoService"}) {
    EXPECT_EQ(Check(server, name), HealthCheckResponse::SERVING) << name;
  }
  EXPECT_EQ(Check(server, "ccst.v1.Nothing"), HealthCheckResponse::SERVICE_UNKNOWN);
}

TEST(Drain, RefusesNewJobsReportsItAndLetsOldOnesFinish) {
  Gate started;
  Gate go;
  TestServer server(GatedSampler(started, go));
  grpc::ClientContext context;
  const auto reader = server.sampling().Sample(&context, Request());
  started.Wait();
  // Watch tells when draining began, without waiting a guessed time.
  const auto health = grpc::health::v1::Health::NewStub(server.channel());
  grpc::ClientContext watch_context;
  const auto watch = health->Watch(&watch_context, HealthCheckRequest());
  HealthCheckResponse state;
  ASSERT_TRUE(watch->Read(&state));
  EXPECT_EQ(state.status(), HealthCheckResponse::SERVING);
  auto drained = std::async(std::launch::async, [&] { server->Drain(); });
  ASSERT_TRUE(watch->Read(&state));
  EXPECT_EQ(state.status(), HealthCheckResponse::NOT_SERVING);
  EXPECT_EQ(Check(server, "ccst.v1.SamplingService"), HealthCheckResponse::NOT_SERVING);
  Answer refused = Sample(server.sampling(), Request());
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(refused.reason(), "DRAINING");
  v1::RetryAdvice advice;
  EXPECT_TRUE(Unpack(refused.details(), advice));
  go.Open();
  const Answer answer = ReadAll(*reader);
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_EQ(answer.events.back().snapshot().state(), v1::Job::STATE_SUCCEEDED);
  drained.wait();
}

TEST(Drain, StopsJobsWhenItsTimeIsOver) {
  Gate started;
  Gate never;
  ServerOptions options;
  options.drain_timeout_seconds = 0.0;
  TestServer server(GatedSampler(started, never), options);
  grpc::ClientContext context;
  const auto reader = server.sampling().Sample(&context, Request());
  started.Wait();
  auto drained = std::async(std::launch::async, [&] { server->Drain(); });
  const Answer answer = ReadAll(*reader);
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(answer.reason(), "DRAINING");
  drained.wait();
}

// Found by a sanitizer: the last task of a call used a service that was gone.
TEST(Drain, ServerMayGoBeforeTheLastTasksOfItsCalls) {
  constexpr int kServers = 10;
  constexpr int kCalls = 8;
  for (int i = 0; i < kServers; ++i) {
    auto server = std::make_unique<TestServer>(QuickSampler());
    std::array<grpc::ClientContext, kCalls> contexts;
    std::vector<std::unique_ptr<grpc::ClientReader<v1::SampleResponse>>> readers;
    for (grpc::ClientContext& context : contexts) {
      readers.push_back(server->sampling().Sample(&context, Request()));
    }
    for (grpc::ClientContext& context : contexts) context.TryCancel();
    for (const auto& reader : readers) ReadAll(*reader);
    server.reset();
  }
}

}  // namespace
}  // namespace ccst::server
