#include "tests/interleavings/remote_service.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>
#include <utility>

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "absl/time/clock.h"
#include "core/base/sha256.h"
#include "core/base/status.h"
#include "core/io/samples_digest.h"
#include "proto/convert/samples.h"
#include "proto/convert/status.h"
#include "server/auth/token.h"

namespace ccst::interleavings {
namespace {

constexpr auto kDeadline = std::chrono::seconds(60);
// Of the jobs' gauges to become those of rest.
constexpr auto kLongestUntilIdle = std::chrono::seconds(60);
constexpr auto kPoll = std::chrono::milliseconds(5);
constexpr std::size_t kChunkBytes = 1000;  // Several chunks even of a small mesh.
constexpr int kJobsOfAPage = 7;
constexpr int kRetentionSeconds = 8;

absl::Status ToStatus(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  v1::Status details;
  if (details.ParseFromString(status.error_details()) && details.code() != 0) {
    return FromProto(details);
  }
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

// One unary call.
template <typename Stub, typename Request, typename Response>
absl::StatusOr<Response> Ask(Stub& stub,
                             grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                          Response*),
                             grpc::ClientContext& context, const Request& request) {
  Response response;
  CCST_RETURN_IF_ERROR(ToStatus((stub.*method)(&context, request, &response)));
  return response;
}

template <typename Request>
Request Named(const std::string& name) {
  Request request;
  request.set_name(name);
  return request;
}

v1::MeshUploadHeader HeaderOf(const std::string& bytes) {
  v1::MeshUploadHeader header;
  header.mutable_digest()->set_sha256(Sha256Of(bytes));
  header.mutable_digest()->set_size_bytes(static_cast<std::int64_t>(bytes.size()));
  header.set_format(v1::MESH_FORMAT_DRACO);
  return header;
}

}  // namespace

absl::StatusOr<std::unique_ptr<RemoteService>> RemoteService::Start(
    std::string program, std::string folder, int owners, std::vector<std::string> flags) {
  std::unique_ptr<RemoteService> service(
      new RemoteService(std::move(program), std::move(folder), std::move(flags)));
  std::ofstream tokens(service->folder_ + "/tokens");
  for (int i = 0; i < owners; ++i) {
    Caller caller;
    CCST_ASSIGN_OR_RETURN(caller.token, server::NewToken());
    tokens << server::TokenLine("owner" + std::to_string(i), server::Scope::kFull, caller.token)
           << '\n';
    service->callers_.push_back(std::move(caller));
  }
  tokens.close();
  CCST_RETURN_IF_ERROR(service->Open());
  return service;
}

absl::Status RemoteService::Open() {
  std::vector<std::string> flags = {"--data-dir",         folder_ + "/data",
                                    "--auth-token-file",  folder_ + "/tokens",
                                    "--job-retention",    std::to_string(kRetentionSeconds),
                                    "--max-running-jobs", "3"};
  flags.insert(flags.end(), flags_.begin(), flags_.end());
  CCST_ASSIGN_OR_RETURN(server_, ServerProcess::Start(program_, flags));
  for (Caller& caller : callers_) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    const auto channel = grpc::CreateCustomChannel(server_->address(),
                                                   grpc::InsecureChannelCredentials(), arguments);
    caller.jobs = v1::SamplingService::NewStub(channel);
    caller.meshes = v1::MeshService::NewStub(channel);
  }
  return absl::OkStatus();
}

std::unique_ptr<grpc::ClientContext> RemoteService::Context(int owner) const {
  auto context = std::make_unique<grpc::ClientContext>();
  context->set_deadline(std::chrono::system_clock::now() + kDeadline);
  context->AddMetadata("authorization", "Bearer " + callers_[Index(owner)].token);
  return context;
}

absl::StatusOr<v1::Job> RemoteService::CreateJob(int owner, const v1::CreateJobRequest& request) {
  v1::CreateJobResponse response;
  CCST_ASSIGN_OR_RETURN(
      response, Ask(jobs(owner), &v1::SamplingService::Stub::CreateJob, *Context(owner), request));
  return std::move(*response.mutable_job());
}

absl::StatusOr<Sampled> RemoteService::Sample(int owner, const v1::SampleRequest& request,
                                              bool leave) {
  const auto context = Context(owner);
  const auto reader = jobs(owner).Sample(context.get(), request);
  Sampled sampled;
  SampleSet samples;
  v1::SampleResponse message;
  while (reader->Read(&message)) {
    if (message.has_snapshot()) sampled.end = std::move(*message.mutable_snapshot());
    if (message.has_samples()) CCST_RETURN_IF_ERROR(AppendChunk(message.samples(), samples));
    if (message.has_sample_mesh())
      CCST_RETURN_IF_ERROR(AppendChunk(message.sample_mesh(), samples));
    if (leave) context->TryCancel();
  }
  const absl::Status status = ToStatus(reader->Finish());
  if (!leave || sampled.end.name().empty()) CCST_RETURN_IF_ERROR(status);
  if (!samples.faces.empty()) sampled.samples = SamplesDigest(samples);
  return sampled;
}

absl::StatusOr<v1::Job> RemoteService::GetJob(int owner, const std::string& name) {
  v1::GetJobResponse response;
  CCST_ASSIGN_OR_RETURN(response, Ask(jobs(owner), &v1::SamplingService::Stub::GetJob,
                                      *Context(owner), Named<v1::GetJobRequest>(name)));
  return std::move(*response.mutable_job());
}

absl::StatusOr<std::vector<v1::Job>> RemoteService::ListJobs(int owner) {
  std::vector<v1::Job> all;
  v1::ListJobsRequest request;
  request.set_page_size(kJobsOfAPage);
  do {
    v1::ListJobsResponse page;
    CCST_ASSIGN_OR_RETURN(
        page, Ask(jobs(owner), &v1::SamplingService::Stub::ListJobs, *Context(owner), request));
    all.insert(all.end(), page.jobs().begin(), page.jobs().end());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return all;
}

absl::StatusOr<Watched> RemoteService::WatchJob(int owner, const std::string& name) {
  const auto context = Context(owner);
  const auto reader = jobs(owner).WatchJob(context.get(), Named<v1::WatchJobRequest>(name));
  Watched watched;
  v1::WatchJobResponse message;
  bool has_gap = false;
  while (reader->Read(&message)) {
    if (message.has_progress()) has_gap |= message.sequence() != ++watched.report_count;
    if (message.has_snapshot()) watched.end = std::move(*message.mutable_snapshot());
  }
  CCST_RETURN_IF_ERROR(ToStatus(reader->Finish()));
  if (has_gap) return absl::DataLossError("the sequence of reports has gaps");
  return watched;
}

absl::StatusOr<v1::Job> RemoteService::CancelJob(int owner, const std::string& name) {
  v1::CancelJobResponse response;
  CCST_ASSIGN_OR_RETURN(response, Ask(jobs(owner), &v1::SamplingService::Stub::CancelJob,
                                      *Context(owner), Named<v1::CancelJobRequest>(name)));
  return std::move(*response.mutable_job());
}

absl::Status RemoteService::DeleteJob(int owner, const std::string& name) {
  return Ask(jobs(owner), &v1::SamplingService::Stub::DeleteJob, *Context(owner),
             Named<v1::DeleteJobRequest>(name))
      .status();
}

absl::StatusOr<std::string> RemoteService::ReadSamples(int owner, const std::string& name) {
  SampleSet samples;
  {
    const auto context = Context(owner);
    const auto reader = jobs(owner).ReadSamples(context.get(), Named<v1::ReadSamplesRequest>(name));
    v1::ReadSamplesResponse message;
    while (reader->Read(&message)) {
      CCST_RETURN_IF_ERROR(AppendChunk(message.samples(), samples));
    }
    CCST_RETURN_IF_ERROR(ToStatus(reader->Finish()));
  }
  const auto context = Context(owner);
  const auto reader =
      jobs(owner).ReadSampleMesh(context.get(), Named<v1::ReadSampleMeshRequest>(name));
  v1::ReadSampleMeshResponse message;
  while (reader->Read(&message)) {
    CCST_RETURN_IF_ERROR(AppendChunk(message.sample_mesh(), samples));
  }
  CCST_RETURN_IF_ERROR(ToStatus(reader->Finish()));
  return SamplesDigest(samples);
}

absl::Status RemoteService::UploadMesh(int owner, const std::string& bytes) {
  const auto context = Context(owner);
  v1::UploadMeshResponse response;
  const auto writer = meshes(owner).UploadMesh(context.get(), &response);
  v1::UploadMeshRequest message;
  *message.mutable_header() = HeaderOf(bytes);
  bool open = writer->Write(message);
  for (std::size_t begin = 0; open && begin < bytes.size(); begin += kChunkBytes) {
    message.mutable_chunk()->set_offset_bytes(static_cast<std::int64_t>(begin));
    message.mutable_chunk()->set_data(bytes.substr(begin, kChunkBytes));
    open = writer->Write(message);
  }
  writer->WritesDone();
  return ToStatus(writer->Finish());
}

absl::StatusOr<std::string> RemoteService::DownloadMesh(int owner, const std::string& name) {
  const auto context = Context(owner);
  const auto reader =
      meshes(owner).DownloadMesh(context.get(), Named<v1::DownloadMeshRequest>(name));
  std::string bytes;
  v1::DownloadMeshResponse message;
  while (reader->Read(&message)) bytes += message.chunk().data();
  CCST_RETURN_IF_ERROR(ToStatus(reader->Finish()));
  return bytes;
}

absl::Status RemoteService::DeleteMesh(int owner, const std::string& name) {
  return Ask(meshes(owner), &v1::MeshService::Stub::DeleteMesh, *Context(owner),
             Named<v1::DeleteMeshRequest>(name))
      .status();
}

absl::StatusOr<std::vector<std::string>> RemoteService::ListMeshes(int owner) {
  std::vector<std::string> names;
  v1::ListMeshesRequest request;
  request.set_page_size(1);
  do {
    v1::ListMeshesResponse page;
    CCST_ASSIGN_OR_RETURN(
        page, Ask(meshes(owner), &v1::MeshService::Stub::ListMeshes, *Context(owner), request));
    for (const v1::Mesh& mesh : page.meshes()) names.push_back(mesh.name());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return names;
}

absl::Time RemoteService::Now() const { return absl::Now(); }

absl::Duration RemoteService::retention() const { return absl::Seconds(kRetentionSeconds); }

absl::Status RemoteService::WaitUntilIdle() {
  const auto deadline = std::chrono::steady_clock::now() + kLongestUntilIdle;
  while (true) {
    double busy = 0.0;
    for (const char* gauge :
         {"ccst_jobs_queued", "ccst_jobs_running", "ccst_watchers", "ccst_memory_bytes"}) {
      double value = 0.0;
      CCST_ASSIGN_OR_RETURN(value, server_->Gauge(gauge));
      busy += value;
    }
    if (busy == 0.0) return absl::OkStatus();
    if (std::chrono::steady_clock::now() > deadline) {
      return absl::DeadlineExceededError("the server is not idle after a minute");
    }
    std::this_thread::sleep_for(kPoll);
  }
}

absl::StatusOr<Holdings> RemoteService::Look() {
  Holdings holdings;
  // Without exceptions: the server may remove a file between two looks.
  std::error_code error;
  std::filesystem::recursive_directory_iterator entry(folder_ + "/data/blobs", error);
  for (; !error && entry != std::filesystem::recursive_directory_iterator();
       entry.increment(error)) {
    std::error_code gone;
    const bool is_file = entry->is_regular_file(gone) && !gone;
    const auto size = is_file ? entry->file_size(gone) : 0;
    if (is_file && !gone) {
      holdings.blobs[entry->path().filename()] = static_cast<std::int64_t>(size);
    }
  }
  if (error) return absl::InternalError("the folder of blobs cannot be read: " + error.message());
  double value = 0.0;
  CCST_ASSIGN_OR_RETURN(value, server_->Gauge("ccst_data_bytes"));
  holdings.counted_bytes = static_cast<std::int64_t>(value);
  CCST_ASSIGN_OR_RETURN(value, server_->Gauge("ccst_memory_bytes"));
  holdings.memory_bytes = static_cast<std::int64_t>(value);
  CCST_ASSIGN_OR_RETURN(value, server_->Gauge("ccst_watchers"));
  holdings.watchers = static_cast<std::int64_t>(value);
  return holdings;
}

absl::Status RemoteService::Restart() {
  server_ = nullptr;
  return Open();
}

}  // namespace ccst::interleavings
