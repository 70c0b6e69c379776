// What `ccst-server --health` asks a running server.
#include "server/app/health_check.h"

#include <cstdlib>
#include <future>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/certificates.h"
#include "tests/server/temp_folder.h"
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

TEST(HealthCheck, ProxiesOfTheEnvironmentAreNotUsed) {
  TestServer server(QuickSampler());
  // Nobody listens there.
  const std::vector<const char*> names = {"http_proxy",  "https_proxy", "grpc_proxy",
                                          "HTTPS_PROXY", "HTTP_PROXY",  "all_proxy"};
  for (const char* name : names) setenv(name, "http://127.0.0.1:1", 1);
  const absl::Status status = CheckHealth(ListeningAt(server->address()));
  for (const char* name : names) unsetenv(name);
  EXPECT_TRUE(status.ok()) << status;
}

TEST(HealthCheck, AnyPortIsNoneThatCanBeAsked) {
  const absl::Status status = CheckHealth(ListeningAt("127.0.0.1:0"));
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
  EXPECT_NE(status.message().find("port"), std::string::npos) << status;
}

// Where callers need a certificate.
class MutualHealthCheck : public testing::Test {
 protected:
  MutualHealthCheck() {
    options_.security.tls.certificate = folder_.Write("cert", own_.certificate);
    options_.security.tls.key = folder_.Write("key", own_.key);
  }
  absl::Status Check(const TestCertificate& client_authority) {
    options_.security.tls.client_ca = folder_.Write("ca", client_authority.certificate);
    TestServer server(QuickSampler(), options_);
    ServerOptions asked = options_;
    asked.listen = server->address();
    return CheckHealth(asked);
  }

  TempFolder folder_;
  const TestCertificate authority_ = MakeAuthority("authority");
  const TestCertificate callers_ = MakeAuthority("callers");
  const TestCertificate own_ = MakeCertificate(authority_, "server");
  ServerOptions options_;
};

TEST_F(MutualHealthCheck, ShowsTheCertificateOfTheServer) {
  const absl::Status status = Check(authority_);
  EXPECT_TRUE(status.ok()) << status;
}

TEST_F(MutualHealthCheck, SaysWhatItNeedsWhereThatIsNotTaken) {
  const absl::Status status = Check(callers_);
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_NE(status.message().find("--health-cert"), std::string::npos) << status;
}

TEST_F(MutualHealthCheck, ShowsTheCertificateItIsGiven) {
  const TestCertificate health = MakeCertificate(callers_, "health");
  options_.security.health_cert = folder_.Write("health-cert", health.certificate);
  options_.security.health_key = folder_.Write("health-key", health.key);
  const absl::Status status = Check(callers_);
  EXPECT_TRUE(status.ok()) << status;
  options_.security.health_key = options_.security.tls.key;
  EXPECT_NE(Check(callers_).message().find("--health-key is not the key of --health-cert"),
            std::string::npos);
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
