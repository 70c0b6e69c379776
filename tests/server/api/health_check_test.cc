// What `ccst-server --health` asks a running server.
#include "server/app/health_check.h"

#include <future>

#include <gtest/gtest.h>

#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

ServerOptions ListeningAt(const std::string& address) {
  ServerOptions options;
  options.listen = address;
  return options;
}

TEST(HealthCheck, ServingServerIsHealthy) {
  TestServer server(QuickSampler());
  EXPECT_TRUE(CheckHealth(ListeningAt(server->address())).ok());
}

TEST(HealthCheck, AllAddressesAreAskedAtLoopback) {
  TestServer server(QuickSampler());
  const std::string port = server->address().substr(server->address().rfind(':'));
  const absl::Status status = CheckHealth(ListeningAt("0.0.0.0" + port));
  EXPECT_TRUE(status.ok()) << status;
}

TEST(HealthCheck, NobodyListeningIsUnavailableAndNamesTheAddress) {
  // Port 1 of the loopback interface is reserved and refuses connections.
  const absl::Status status = CheckHealth(ListeningAt("127.0.0.1:1"));
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_NE(status.message().find("127.0.0.1:1"), std::string::npos) << status;
}

TEST(HealthCheck, DrainingServerIsNotHealthy) {
  Gate started;
  Gate go;
  TestServer server(GatedSampler(started, go));
  grpc::ClientContext context;
  const auto reader = server.sampling().Sample(&context, Request());
  started.Wait();
  auto drained = std::async(std::launch::async, [&] { server->Drain(); });
  // Until draining has begun it is healthy.
  absl::Status status = CheckHealth(ListeningAt(server->address()));
  while (status.ok()) status = CheckHealth(ListeningAt(server->address()));
  EXPECT_TRUE(absl::IsFailedPrecondition(status)) << status;
  go.Open();
  ReadAll(*reader);
  drained.wait();
}

}  // namespace
}  // namespace ccst::server
