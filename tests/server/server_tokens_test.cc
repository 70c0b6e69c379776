// Who gets in with which token, at a real server.
#include <string>

#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "grpc/health/v1/health.grpc.pb.h"
#include "server/auth/token.h"
#include "tests/server/temp_folder.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

constexpr char kFull[] = "ccst_full-token";
constexpr char kReader[] = "ccst_reader-token";
constexpr char kMesh[] = "bytes-of-a-mesh";

class ServerTokensTest : public testing::Test {
 protected:
  static std::string Lines() {
    return TokenLine("alice", Scope::kFull, kFull) + "\n" +
           TokenLine("bob", Scope::kReadOnly, kReader) + "\n";
  }
  static ServerOptions Options(const TempFolder& folder) {
    ServerOptions options;
    options.security.auth_token_file = folder.Write("secret-tokens", Lines());
    return options;
  }

  grpc::Status Info(const std::string& token) {
    grpc::ClientContext context;
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    v1::GetServerInfoResponse response;
    return server_.info().GetServerInfo(&context, {}, &response);
  }
  Answer Sample(const std::string& token) {
    grpc::ClientContext context;
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    v1::SampleRequest request = Request();
    request.mutable_inline_mesh()->set_data(kMesh);
    return ReadAll(*server_.sampling().Sample(&context, request));
  }

  TempFolder folder_;
  TestServer server_{QuickSampler(), Options(folder_)};
};

TEST_F(ServerTokensTest, FullTokenMayDoEverything) {
  EXPECT_TRUE(Info(kFull).ok());
  EXPECT_TRUE(Sample(kFull).status.ok());
}

TEST_F(ServerTokensTest, ReadOnlyTokenMayLookAndNotSample) {
  EXPECT_TRUE(Info(kReader).ok());
  const Answer answer = Sample(kReader);
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::PERMISSION_DENIED);
  EXPECT_EQ(answer.reason(), "PERMISSION_DENIED");
  EXPECT_TRUE(answer.events.empty());
}

TEST_F(ServerTokensTest, NoTokenAndAWrongOneAreRefused) {
  for (const std::string token : {"", "ccst_wrong", "ccst_full-toke", "ccst_full-tokens"}) {
    EXPECT_EQ(Info(token).error_code(), grpc::StatusCode::UNAUTHENTICATED) << token;
    const Answer answer = Sample(token);
    EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << token;
    EXPECT_EQ(answer.reason(), "UNAUTHENTICATED") << token;
  }
}

TEST_F(ServerTokensTest, RemovedTokenIsRefusedWithTheNextCall) {
  EXPECT_TRUE(Info(kFull).ok());
  folder_.Write("secret-tokens", TokenLine("bob", Scope::kReadOnly, kReader) + "\n");
  EXPECT_EQ(Info(kFull).error_code(), grpc::StatusCode::UNAUTHENTICATED);
  EXPECT_TRUE(Info(kReader).ok());
}

TEST_F(ServerTokensTest, HealthNeedsNone) {
  const auto stub = grpc::health::v1::Health::NewStub(server_.channel());
  grpc::ClientContext context;
  grpc::health::v1::HealthCheckResponse response;
  ASSERT_TRUE(stub->Check(&context, {}, &response).ok());
  EXPECT_EQ(response.status(), grpc::health::v1::HealthCheckResponse::SERVING);
}

TEST_F(ServerTokensTest, LogNamesOwnersAndNoSecrets) {
  Sample(kFull);
  Sample(kReader);
  Sample("ccst_wrong");
  folder_.Write("secret-tokens", "nonsense");
  Info(kFull);
  server_->Drain();  // Every call is done, and so is its line.
  std::string log;
  for (const std::string& line : server_.LogLines()) log += line + "\n";
  for (const char* said : {" Sample OK ", "owner=alice", "PERMISSION_DENIED", "owner=bob",
                           "UNAUTHENTICATED", "owner=127.0.0.1", "tokens not reloaded"}) {
    EXPECT_NE(log.find(said), std::string::npos) << said << "\n" << log;
  }
  for (const char* secret : {kFull, kReader, "ccst_", kMesh, "secret-tokens", "nonsense"}) {
    EXPECT_EQ(log.find(secret), std::string::npos) << secret << "\n" << log;
  }
}

// How the server answers a call of reflection that it cannot understand.
grpc::StatusCode AskReflection(TestServer& server) {
  grpc::GenericStub stub(server.channel());
  grpc::CompletionQueue queue;
  grpc::ClientContext context;
  const grpc::Slice slice("\xFF");
  const grpc::ByteBuffer request(&slice, 1);
  const auto call = stub.PrepareUnaryCall(
      &context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", request, &queue);
  call->StartCall();
  grpc::ByteBuffer response;
  grpc::Status status;
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  EXPECT_TRUE(queue.Next(&tag, &ok));
  return status.error_code();
}

TEST(Reflection, IsForOtherMachinesOnlyWhenAskedFor) {
  ServerOptions options;
  options.listen = "0.0.0.0:0";
  options.security.insecure = true;
  options.security.without_proxy = true;
  {
    TestServer server(QuickSampler(), options);
    EXPECT_EQ(AskReflection(server), grpc::StatusCode::UNIMPLEMENTED);
  }
  options.security.reflection = true;
  TestServer server(QuickSampler(), options);
  EXPECT_NE(AskReflection(server), grpc::StatusCode::UNIMPLEMENTED);
}

}  // namespace
}  // namespace ccst::server
