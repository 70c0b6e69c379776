// Certificates at a real server: who gets through the handshake, and what a changed file does.
#include <chrono>
#include <memory>
#include <string>

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <gtest/gtest.h>

#include "tests/server/certificates.h"
#include "tests/server/temp_folder.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

class ServerTlsTest : public testing::Test {
 protected:
  void Start(bool with_client_ca = false) {
    ServerOptions options;
    options.security.tls.certificate = folder_.Write("cert", server_certificate_.certificate);
    options.security.tls.key = folder_.Write("key", server_certificate_.key);
    if (with_client_ca) {
      options.security.tls.client_ca = folder_.Write("ca", authority_.certificate);
    }
    server_ = std::make_unique<TestServer>(QuickSampler(), options);
  }

  // A connection of its own that trusts `ca` and shows `own`.
  std::shared_ptr<grpc::Channel> Connect(const std::string& ca, const TestCertificate& own) {
    grpc::SslCredentialsOptions options;
    options.pem_root_certs = ca;
    options.pem_cert_chain = own.certificate;
    options.pem_private_key = own.key;
    return Connect(grpc::SslCredentials(options));
  }
  std::shared_ptr<grpc::Channel> Connect(
      const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel((*server_)->address(), credentials, arguments);
  }

  // One call over such a connection.
  grpc::Status Info(const std::string& ca, const TestCertificate& own = {}) {
    return Info(Connect(ca, own));
  }
  grpc::Status Info(const std::shared_ptr<grpc::Channel>& channel) {
    const auto stub = v1::ServerInfoService::NewStub(channel);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    v1::GetServerInfoResponse response;
    return stub->GetServerInfo(&context, {}, &response);
  }

  // A job of the holder of these names; empty when it was refused.
  std::string MakeJob(const TestNames& names) {
    const auto channel = Connect(authority_.certificate, MakeCertificateOf(authority_, names));
    const Answer answer = Sample(*v1::SamplingService::NewStub(channel), Request());
    EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
    return answer.events.empty() ? "" : answer.events.front().snapshot().name();
  }
  grpc::Status SeesJob(const TestNames& names, const std::string& job) {
    const auto channel = Connect(authority_.certificate, MakeCertificateOf(authority_, names));
    v1::GetJobRequest request;
    request.set_name(job);
    v1::GetJobResponse response;
    grpc::ClientContext context;
    return v1::SamplingService::NewStub(channel)->GetJob(&context, request, &response);
  }

  bool LogHas(const std::string& text) {
    for (const std::string& line : server_->LogLines()) {
      if (line.find(text) != std::string::npos) return true;
    }
    return false;
  }

  TempFolder folder_;
  const TestCertificate authority_ = MakeAuthority("authority");
  const TestCertificate other_authority_ = MakeAuthority("other");
  const TestCertificate server_certificate_ = MakeCertificate(authority_, "server");
  std::unique_ptr<TestServer> server_;
};

TEST_F(ServerTlsTest, CallerThatTrustsTheAuthorityGetsThrough) {
  Start();
  const grpc::Status status = Info(authority_.certificate);
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST_F(ServerTlsTest, CallerThatTrustsAnotherOrSpeaksPlaintextDoesNot) {
  Start();
  EXPECT_EQ(Info(other_authority_.certificate).error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(Info(Connect(grpc::InsecureChannelCredentials())).error_code(),
            grpc::StatusCode::UNAVAILABLE);
}

TEST_F(ServerTlsTest, ClientNeedsACertificateOfTheAuthority) {
  Start(true);
  const grpc::Status status = Info(authority_.certificate, MakeCertificate(authority_, "client-1"));
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(LogHas(" GetServerInfo OK "));
  EXPECT_TRUE(LogHas(" owner=client-1#"));
  EXPECT_EQ(Info(authority_.certificate).error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(Info(authority_.certificate, MakeCertificate(other_authority_, "x")).error_code(),
            grpc::StatusCode::UNAVAILABLE);
}

TEST_F(ServerTlsTest, HoldersWhoseNamesDifferSeeNothingOfEachOther) {
  Start(true);
  const TestNames owner = {.subject = {{.type = "CN", .value = "Zo\u00eb"}},
                           .alternatives = "DNS:shared,DNS:one"};
  const TestNames other_letter = {.subject = {{.type = "CN", .value = "Zo\u00e9"}},
                                  .alternatives = "DNS:shared,DNS:one"};
  const TestNames other_alternative = {.subject = {{.type = "CN", .value = "Zo\u00eb"}},
                                       .alternatives = "DNS:shared,DNS:two"};
  const std::string job = MakeJob(owner);
  EXPECT_TRUE(SeesJob(owner, job).ok());  // With another key.
  for (const TestNames& stranger : {other_letter, other_alternative}) {
    EXPECT_EQ(SeesJob(stranger, job).error_code(), grpc::StatusCode::NOT_FOUND);
  }
}

TEST_F(ServerTlsTest, CertificateThatNamesNobodyIsRefused) {
  Start(true);
  const grpc::Status status = Info(authority_.certificate, MakeCertificateOf(authority_, {}));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_NE(status.error_message().find("names nobody"), std::string::npos)
      << status.error_message();
}

TEST_F(ServerTlsTest, ChangedCertificateCountsWithTheNextConnection) {
  Start();
  ASSERT_TRUE(Info(authority_.certificate).ok());
  const TestCertificate next = MakeCertificate(other_authority_, "server");
  folder_.Write("cert", next.certificate);
  folder_.Write("key", next.key);
  const grpc::Status status = Info(other_authority_.certificate);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(Info(authority_.certificate).error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(LogHas("certificate reloaded"));
}

TEST_F(ServerTlsTest, BrokenFileLeavesTheOldCertificateAndIsLogged) {
  Start();
  ASSERT_TRUE(Info(authority_.certificate).ok());
  const TestCertificate next = MakeCertificate(authority_, "server");
  for (const std::string& broken : {std::string("not PEM"), next.certificate}) {
    folder_.Write("cert", broken);  // The second is of another key.
    const grpc::Status status = Info(authority_.certificate);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
  EXPECT_TRUE(LogHas("certificate not reloaded, the old one stays: --tls-cert is no "));
  EXPECT_TRUE(LogHas("certificate not reloaded, the old one stays: --tls-key is not "));
  EXPECT_FALSE(LogHas(folder_.Path("")));
  folder_.Write("key", next.key);
  EXPECT_TRUE(Info(authority_.certificate).ok());
  EXPECT_TRUE(LogHas("certificate reloaded"));
}

TEST_F(ServerTlsTest, ChangedClientAuthorityCountsWithTheNextConnection) {
  Start(true);
  const TestCertificate old_client = MakeCertificate(authority_, "old");
  ASSERT_TRUE(Info(authority_.certificate, old_client).ok());
  folder_.Write("ca", other_authority_.certificate);
  EXPECT_FALSE(Info(authority_.certificate, old_client).ok());
  EXPECT_TRUE(Info(authority_.certificate, MakeCertificate(other_authority_, "new")).ok());
}

TEST_F(ServerTlsTest, StartNeedsFilesThatGoTogether) {
  ServerOptions options;
  options.listen = "127.0.0.1:0";
  options.security.tls.certificate = folder_.Write("cert", server_certificate_.certificate);
  options.security.tls.key = folder_.Write("key", authority_.key);
  const auto server = Server::Start(options, Server::RealDependencies(options));
  EXPECT_EQ(server.status().message(), "--tls-key is not the key of --tls-cert");
}

}  // namespace
}  // namespace ccst::server
