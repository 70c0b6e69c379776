#include "server/rpc/upload_reactor.h"

#include <string>
#include <utility>

#include "absl/time/time.h"
#include "core/base/status.h"
#include "proto/convert/violations.h"
#include "server/rpc/mesh_messages.h"
#include "server/rpc/rpc_executor.h"

namespace ccst::server {
namespace {

absl::Status Invalid(const std::string& field, const std::string& description) {
  Violations violations;
  violations.Add(field, description, ErrorReason::kRequestInvalid);
  return violations.ToStatus();
}

absl::Status CheckChunk(const v1::MeshChunk& chunk, std::int64_t received, std::int64_t announced,
                        std::int64_t max_chunk_bytes) {
  const auto bytes = static_cast<std::int64_t>(chunk.data().size());
  if (chunk.offset_bytes() != received) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kChunkOffsetMismatch,
                     "a chunk starts at byte " + std::to_string(chunk.offset_bytes()) +
                         "; the one before ended at byte " + std::to_string(received));
  }
  if (bytes == 0) return Invalid("chunk.data", "must not be empty");
  if (bytes > max_chunk_bytes) {
    Violations violations;
    violations.AddLimit("chunk.data", "max_chunk_bytes", max_chunk_bytes, bytes);
    return violations.ToStatus();
  }
  if (bytes > announced - received) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDigestMismatch,
                     "announced are " + std::to_string(announced) + " bytes, at least " +
                         std::to_string(received + bytes) + " came");
  }
  return absl::OkStatus();
}

}  // namespace

UploadReactor* UploadReactor::Start(MeshSupport& support, grpc::CallbackServerContext& context,
                                    v1::UploadMeshResponse& response) {
  auto reactor = std::make_shared<UploadReactor>(support, context, response);
  reactor->self_ = reactor;
  reactor->Begin();
  return reactor.get();
}

UploadReactor::UploadReactor(MeshSupport& support, grpc::CallbackServerContext& context,
                             v1::UploadMeshResponse& response)
    : support_(support), context_(context), response_(response) {
  call_.emplace(support.calls, context, "UploadMesh", Scope::kFull);
}

void UploadReactor::Begin() {
  idle_ = std::make_unique<IdleTimer>(support_.options.max_idle, [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->OnIdle();
  });
  MutexLock lock(mutex_);
  if (!call_->admission().ok()) return FinishWith(call_->admission());
  auto slot = support_.uploads.Take(call_->caller().owner);
  if (!slot.ok()) return FinishWith(slot.status());
  slot_.emplace(*std::move(slot));
  ReadNext();
}

void UploadReactor::ReadNext() {
  reading_ = true;
  idle_->Start();
  StartRead(&message_);
}

void UploadReactor::OnReadDone(bool ok) {
  idle_->Stop();
  MutexLock lock(mutex_);
  reading_ = false;
  if (finished_) return;
  const absl::Status received = ok ? call_->Received(message_) : absl::OkStatus();
  if (!received.ok()) return FinishWith(received);
  const absl::StatusOr<Step> step = Next(ok);
  if (!step.ok()) return FinishWith(step.status());
  Post(*step);
}

absl::StatusOr<UploadReactor::Step> UploadReactor::Next(bool ok) {
  if (!ok && context_.IsCancelled()) {
    return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                     "the caller went away or its deadline passed");
  }
  if (!has_header_) {
    if (!ok || !message_.has_header()) {
      return Invalid("header", "must come first, before any chunk");
    }
    has_header_ = true;
    return &UploadReactor::TakeHeader;
  }
  if (!ok) return &UploadReactor::StoreMesh;
  if (!message_.has_chunk()) return Invalid("chunk", "must be in every message but the first");
  CCST_RETURN_IF_ERROR(CheckPace());
  CCST_RETURN_IF_ERROR(CheckChunk(message_.chunk(), writer_->size_bytes(), upload_.size_bytes,
                                  support_.options.max_chunk_bytes));
  return &UploadReactor::AppendChunk;
}

absl::Status UploadReactor::CheckPace() const {
  const MeshServiceOptions& options = support_.options;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  const double allowed = absl::ToDoubleSeconds(options.max_idle) +
                         static_cast<double>(writer_->size_bytes()) / options.min_bytes_per_second;
  if (seconds <= allowed) return absl::OkStatus();
  return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                   std::to_string(writer_->size_bytes()) + " bytes in " + std::to_string(seconds) +
                       " seconds are too few to keep others waiting; at least " +
                       std::to_string(options.min_bytes_per_second) +
                       " a second must come; upload again from the start");
}

void UploadReactor::Post(Step step) {
  Executor& executor = step == &UploadReactor::StoreMesh ? support_.decoding : support_.disk;
  const bool accepted = executor.Run([self = shared_from_this(), step] { self->Run(step); });
  if (!accepted) FinishWith(ExecutorFull());
}

void UploadReactor::Run(Step step) {
  const absl::Status status = RunStep([&] { return (this->*step)(); });
  MutexLock lock(mutex_);
  if (!status.ok() || stored_) return FinishWith(status);
  ReadNext();
}

absl::Status UploadReactor::TakeHeader() {
  std::string owner;
  {
    MutexLock lock(mutex_);
    owner = call_->caller().visible_owner();
  }
  CCST_ASSIGN_OR_RETURN(upload_, FromProto(message_.header(), owner, support_.meshes.options()));
  bool held = false;
  CCST_ASSIGN_OR_RETURN(held, FindHeld(support_.meshes, upload_, *response_.mutable_mesh()));
  if (held) {
    response_.set_already_present(true);
    stored_ = true;
    return absl::OkStatus();
  }
  auto writer = support_.meshes.Begin(upload_);
  if (!writer.ok()) return writer.status();
  writer_ = *std::move(writer);
  return absl::OkStatus();
}

absl::Status UploadReactor::AppendChunk() { return writer_->Append(message_.chunk().data()); }

absl::Status UploadReactor::StoreMesh() {
  message_.Clear();
  const auto mesh = support_.meshes.Finish(upload_, *writer_);
  if (!mesh.ok()) return mesh.status();
  *response_.mutable_mesh() = ToProto(*mesh);
  stored_ = true;
  return absl::OkStatus();
}

void UploadReactor::OnIdle() {
  MutexLock lock(mutex_);
  // The message may have come, or the call ended, just now.
  if (!reading_ || finished_) return;
  FinishWith(MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                       "no message came for " + absl::FormatDuration(support_.options.max_idle) +
                           "; upload again from the start"));
}

void UploadReactor::FinishWith(const absl::Status& status) {
  finished_ = true;
  if (status.ok()) call_->Sent(response_);
  Finish(call_->End(status));
}

void UploadReactor::OnDone() {
  if (writer_ != nullptr) {
    // What was not committed is deleted, which blocks; this is one of gRPC's threads.
    support_.disk.Run([writer = std::shared_ptr<BlobWriter>(std::move(writer_))] {});
  }
  slot_.reset();
  {
    MutexLock lock(mutex_);
    call_.reset();
  }
  // Who still holds this, an executor or a timer, is about to let go, and touches nothing of the
  // server any more, which may go away once this returned.
  self_.reset();
}

}  // namespace ccst::server
