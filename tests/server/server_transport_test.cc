// What the transport and the mesh's bytes may do to the server.
#include <memory>
#include <string>
#include <vector>

#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/proto_buffer_reader.h>
#include <grpcpp/support/proto_buffer_writer.h>
#include <gtest/gtest.h>

#include "core/base/version.h"
#include "core/io/draco_mesh.h"
#include "core/sampling/algorithm_revision.h"
#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "google/protobuf/text_format.h"
#include "server/app/system.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

// The real decoder, a quick sampler.
RunDependencies RunWithDraco() {
  RunDependencies run = RealRunDependencies(SystemClock(), {});
  run.sample = QuickSampler();
  return run;
}

std::string Tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return *EncodeDraco(mesh);
}

TEST(Transport, OverlongMeshIsRefusedWithItsLimit) {
  ServerOptions options;
  options.request_limits.max_inline_mesh_bytes = 1000;
  options.request_limits.max_texture_bytes = 1000;
  TestServer server(QuickSampler(), options);
  v1::SampleRequest request = Request();
  request.mutable_inline_mesh()->set_data(std::string(1001, 'x'));
  const Answer answer = Sample(server.sampling(), request);
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(answer.reason(), "LIMIT_EXCEEDED");
  v1::LimitViolation violation;
  ASSERT_TRUE(Unpack(answer.details(), violation));
  EXPECT_EQ(violation.limit(), "max_inline_mesh_bytes");
  EXPECT_EQ(violation.requested_value(), 1001);

  request.mutable_inline_mesh()->set_data(std::string(3 << 20, 'x'));
  EXPECT_EQ(Sample(server.sampling(), request).status.error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(Sample(server.sampling(), Request()).status.ok());
}

TEST(Transport, MeshOfTheFullLimitArrives) {
  ServerOptions options;
  options.request_limits.max_inline_mesh_bytes = 64 << 20;
  TestServer server(QuickSampler(), options);
  v1::SampleRequest request = Request();
  request.mutable_inline_mesh()->set_data(std::string(64 << 20, 'x'));
  const Answer answer = Sample(server.sampling(), request);
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
}

TEST(Transport, HostileBytesAreRefusedAndTheNextCallerServed) {
  TestServer server(RunWithDraco(), {});
  const std::string right = Tetrahedron();
  std::vector<std::string> hostile = {"D", "DRACO", std::string(90, '\xFF'),
                                      "DRACO" + std::string(85, '\xFF'), "not a mesh at all"};
  for (std::size_t length = 1; length < right.size(); length += 7) {
    hostile.push_back(right.substr(0, length));
  }
  for (const std::string& bytes : hostile) {
    v1::SampleRequest request = Request();
    request.mutable_inline_mesh()->set_data(bytes);
    const Answer answer = Sample(server.sampling(), request);
    EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT)
        << bytes.size() << " bytes: " << answer.status.error_message();
  }
  // Every byte turned over: a result or a refusal.
  for (std::size_t i = 0; i < right.size(); ++i) {
    v1::SampleRequest request = Request();
    std::string bytes = right;
    bytes[i] = static_cast<char>(~bytes[i]);
    request.mutable_inline_mesh()->set_data(bytes);
    const Answer answer = Sample(server.sampling(), request);
    EXPECT_TRUE(answer.status.ok() ||
                answer.status.error_code() == grpc::StatusCode::INVALID_ARGUMENT)
        << "byte " << i << ": " << answer.status.error_message();
  }
  v1::SampleRequest request = Request();
  request.mutable_inline_mesh()->set_data(right);
  EXPECT_TRUE(Sample(server.sampling(), request).status.ok());
}

// One question to the reflection service, and its answer, as text. Debian ships no headers of the
// service's messages, but their descriptors are in the library.
std::string AskReflection(TestServer& server, const std::string& question) {
  const auto* pool = google::protobuf::DescriptorPool::generated_pool();
  auto* factory = google::protobuf::MessageFactory::generated_factory();
  const auto make = [&](const char* name) {
    return std::unique_ptr<google::protobuf::Message>(
        factory->GetPrototype(pool->FindMessageTypeByName(name))->New());
  };
  const auto request = make("grpc.reflection.v1alpha.ServerReflectionRequest");
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(question, request.get()));
  grpc::ByteBuffer buffer;
  bool own = false;
  EXPECT_TRUE(
      grpc::SerializationTraits<google::protobuf::Message>::Serialize(*request, &buffer, &own)
          .ok());
  grpc::CompletionQueue queue;
  grpc::GenericStub stub(server.channel());
  grpc::ClientContext context;
  const auto call = stub.PrepareCall(
      &context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
  const auto wait = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  call->StartCall(nullptr);
  EXPECT_TRUE(wait());
  call->Write(buffer, nullptr);
  EXPECT_TRUE(wait());
  grpc::ByteBuffer answer;
  call->Read(&answer, nullptr);
  EXPECT_TRUE(wait());
  call->WritesDone(nullptr);
  EXPECT_TRUE(wait());
  grpc::Status status;
  call->Finish(&status, nullptr);
  EXPECT_TRUE(wait());
  const auto response = make("grpc.reflection.v1alpha.ServerReflectionResponse");
  EXPECT_TRUE(
      grpc::SerializationTraits<google::protobuf::Message>::Deserialize(&answer, response.get())
          .ok());
  return response->ShortDebugString();
}

TEST(Transport, ReflectionListsAndDescribesTheServices) {
  TestServer server(QuickSampler());
  const std::string list = AskReflection(server, "list_services: ''");
  for (const std::string name :
       {"ccst.v1.SamplingService", "ccst.v1.ServerInfoService", "grpc.health.v1.Health"}) {
    EXPECT_NE(list.find('"' + name + '"'), std::string::npos) << list;
    const std::string description = AskReflection(server, "file_containing_symbol: '" + name + "'");
    EXPECT_NE(description.find("file_descriptor_response"), std::string::npos) << description;
  }
}

TEST(ServerInfo, SaysEverything) {
  ServerOptions options;
  options.runner = {.max_running_jobs = 3, .max_queued_jobs = 7};
  TestServer server(QuickSampler(), options);
  grpc::ClientContext context;
  v1::GetServerInfoResponse info;
  ASSERT_TRUE(server.info().GetServerInfo(&context, {}, &info).ok());
  EXPECT_EQ(info.server_version(), ProjectVersion());
  EXPECT_EQ(info.source_revision(), SourceRevision());
  EXPECT_EQ(info.algorithm_revision(), kAlgorithmRevision);
  EXPECT_EQ(info.limits().max_running_jobs(), 3);
  EXPECT_EQ(info.limits().max_queued_jobs(), 7);
  // Every limit that is declared is filled in.
  std::vector<const google::protobuf::FieldDescriptor*> set;
  info.limits().GetReflection()->ListFields(info.limits(), &set);
  EXPECT_EQ(static_cast<int>(set.size()), v1::ServerLimits::descriptor()->field_count());
  set.clear();
  info.GetReflection()->ListFields(info, &set);
  EXPECT_EQ(static_cast<int>(set.size()), v1::GetServerInfoResponse::descriptor()->field_count());
}

TEST(ServerLog, HasOneLineARequest) {
  TestServer server(QuickSampler());
  const Answer answer = Sample(server.sampling(), Request(12));
  const std::string job = answer.events.back().snapshot().name();
  Sample(server.sampling(), Request(1));
  server->Drain();  // Every call is done, and so is its line.
  int right = 0;
  int refused = 0;
  for (const std::string& line : server.LogLines()) {
    right += line.find(job) != std::string::npos && line.find("samples=12/12") != std::string::npos;
    refused += line.find("INVALID_ARGUMENT OPTION_INVALID") != std::string::npos;
  }
  EXPECT_EQ(right, 1);
  EXPECT_EQ(refused, 1);
}

}  // namespace
}  // namespace ccst::server
