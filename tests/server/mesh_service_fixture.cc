#include "tests/server/mesh_service_fixture.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include "core/io/draco_mesh.h"
#include "tests/support/shapes.h"

namespace ccst::server {
namespace {

constexpr char kTokenOf[] = "token-of-";

std::string TokenFile(const std::string& folder) {
  const std::string path = folder + "/tokens";
  std::ofstream file(path);
  for (const char* name : {"ann", "bob"}) {
    file << TokenLine(name, Scope::kFull, std::string(kTokenOf) + name) << '\n';
  }
  file << TokenLine("eve", Scope::kReadOnly, std::string(kTokenOf) + "eve") << '\n';
  file << TokenLine("ann", Scope::kReadOnly, std::string(kTokenOf) + "ann-reads") << '\n';
  return path;
}

}  // namespace

MeshServiceTest::MeshServiceTest()
    : clock_{.now = [this] { return now_; }, .seconds = [] { return 0.0; }},
      dependencies_(RealMeshDependencies(clock_)),
      log_(LogFormat::kText, clock_.now, [this](const std::string& line) { WriteLog(line); }),
      pins_(*store_) {
  const absl::Status status =
      authenticator_.UseTokens(TokenFile(folder_.path()), [](const std::string& /*line*/) {});
  if (!status.ok()) throw std::runtime_error(status.ToString());
}

MeshServiceTest::~MeshServiceTest() {
  if (server_ != nullptr) server_->Shutdown();
}

void MeshServiceTest::AcceptAnyBytes() {
  dependencies_.decode = [](std::span<const char>, const MeshLimits&) { return shapes::Cube(); };
}

v1::MeshService::Stub& MeshServiceTest::stub() {
  if (stub_ == nullptr) StartServer();
  return *stub_;
}

void MeshServiceTest::StartServer() {
  meshes_.emplace(*store_, pins_, store_options_, dependencies_);
  // One thread each: what is posted first is done first.
  disk_.emplace(1, max_waiting_);
  decoding_.emplace(1, max_waiting_);
  calls_.emplace(CallSupport{.authenticator = authenticator_,
                             .peers = peers_,
                             .log = log_,
                             .metrics = metrics_,
                             .clock = clock_});
  stream_memory_.emplace(stream_limits_);
  service_.emplace(
      *meshes_, *disk_, *decoding_,
      StreamSupport{
          .calls = *calls_, .executor = *disk_, .open = streams_, .memory = *stream_memory_},
      options_);
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&*service_);
  server_ = builder.BuildAndStart();
  if (server_ == nullptr) throw std::runtime_error("cannot listen");
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  stub_ = v1::MeshService::NewStub(grpc::CreateCustomChannel(
      "127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials(), arguments));
}

std::unique_ptr<grpc::ClientContext> MeshServiceTest::As(const std::string& caller) const {
  auto context = std::make_unique<grpc::ClientContext>();
  context->AddMetadata("authorization", "Bearer " + std::string(kTokenOf) + caller);
  return context;
}

Reply<v1::UploadMeshResponse> MeshServiceTest::Upload(const std::string& bytes,
                                                      const std::string& caller,
                                                      std::size_t chunk_bytes) {
  Reply<v1::UploadMeshResponse> reply;
  const auto context = As(caller);
  const auto writer = stub().UploadMesh(context.get(), &reply.response);
  bool open = writer->Write(HeaderMessage(bytes));
  for (std::size_t offset = 0; open && offset < bytes.size(); offset += chunk_bytes) {
    open = writer->Write(
        ChunkMessage(static_cast<std::int64_t>(offset), bytes.substr(offset, chunk_bytes)));
  }
  writer->WritesDone();
  reply.status = writer->Finish();
  return reply;
}

Reply<v1::UploadMeshResponse> MeshServiceTest::Send(
    const std::vector<v1::UploadMeshRequest>& messages, bool close) {
  Reply<v1::UploadMeshResponse> reply;
  const auto context = As("ann");
  const auto writer = stub().UploadMesh(context.get(), &reply.response);
  for (const v1::UploadMeshRequest& message : messages) {
    if (!writer->Write(message)) break;
  }
  if (close) writer->WritesDone();
  reply.status = writer->Finish();
  return reply;
}

Reply<v1::CreateMeshResponse> MeshServiceTest::Create(const v1::CreateMeshRequest& request,
                                                      const std::string& caller) {
  Reply<v1::CreateMeshResponse> reply;
  reply.status = stub().CreateMesh(As(caller).get(), request, &reply.response);
  return reply;
}

Reply<v1::GetMeshResponse> MeshServiceTest::Get(const std::string& name,
                                                const std::string& caller) {
  Reply<v1::GetMeshResponse> reply;
  v1::GetMeshRequest request;
  request.set_name(name);
  reply.status = stub().GetMesh(As(caller).get(), request, &reply.response);
  return reply;
}

void MeshServiceTest::WriteLog(const std::string& line) {
  const std::lock_guard lock(mutex_);
  log_lines_.push_back(line);
  logged_.notify_all();
}

std::vector<std::string> MeshServiceTest::LogLines() {
  const std::lock_guard lock(mutex_);
  return log_lines_;
}

void MeshServiceTest::WaitForCalls(std::size_t count) {
  std::unique_lock lock(mutex_);
  logged_.wait(lock, [&] { return log_lines_.size() >= count; });
  // What a call posted for cleaning up is done before what is posted now.
  bool done = false;
  ASSERT_TRUE(disk_->Run([&] {
    const std::lock_guard inner(mutex_);
    done = true;
    logged_.notify_all();
  }));
  logged_.wait(lock, [&] { return done; });
}

std::size_t MeshServiceTest::FileCount() const {
  std::size_t count = 0;
  for (const char* folder : {"/blobs", "/incoming"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory_ + folder)) {
      count += entry.is_regular_file() ? 1 : 0;
    }
  }
  return count;
}

std::string SphereBytes() { return *EncodeDraco(shapes::Icosphere(3)); }

v1::MeshUploadHeader HeaderOf(const std::string& bytes) {
  v1::MeshUploadHeader header;
  header.mutable_digest()->set_sha256(Digest(bytes));
  header.mutable_digest()->set_size_bytes(static_cast<std::int64_t>(bytes.size()));
  header.set_format(v1::MESH_FORMAT_DRACO);
  header.set_display_name("a sphere");
  return header;
}

v1::UploadMeshRequest HeaderMessage(const std::string& bytes) {
  v1::UploadMeshRequest message;
  *message.mutable_header() = HeaderOf(bytes);
  return message;
}

v1::UploadMeshRequest ChunkMessage(std::int64_t offset, const std::string& data) {
  v1::UploadMeshRequest message;
  message.mutable_chunk()->set_offset_bytes(offset);
  message.mutable_chunk()->set_data(data);
  return message;
}

std::string ReasonOf(const grpc::Status& status) {
  return DetailOf<v1::ErrorInfo>(status).value_or(v1::ErrorInfo()).reason();
}

void ExpectStatus(const grpc::Status& status, grpc::StatusCode code, const std::string& reason) {
  EXPECT_EQ(status.error_code(), code) << status.error_message();
  EXPECT_EQ(ReasonOf(status), reason) << status.error_message();
}

std::vector<std::string> WrongFields(const grpc::Status& status) {
  const auto violations = DetailOf<v1::FieldViolations>(status).value_or(v1::FieldViolations());
  std::vector<std::string> fields;
  for (const auto& violation : violations.field_violations()) fields.push_back(violation.field());
  return fields;
}

}  // namespace ccst::server
