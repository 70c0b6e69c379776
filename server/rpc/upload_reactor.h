#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ccst/v1/mesh_service.pb.h"
#include "server/base/mutex.h"
#include "server/rpc/call.h"
#include "server/rpc/idle_timer.h"
#include "server/rpc/mesh_support.h"

namespace ccst::server {

/// One `UploadMesh` call. The next message is read when the one before is on the disk, so that it
/// holds one chunk however fast the caller sends. Nothing stays of an upload that breaks, stalls or
/// is refused.
class UploadReactor final : public grpc::ServerReadReactor<v1::UploadMeshRequest>,
                            public std::enable_shared_from_this<UploadReactor> {
 public:
  /// The reactor, which keeps itself alive until the call is done.
  static UploadReactor* Start(MeshSupport& support, grpc::CallbackServerContext& context,
                              v1::UploadMeshResponse& response);

  UploadReactor(MeshSupport& support, grpc::CallbackServerContext& context,
                v1::UploadMeshResponse& response);

  void OnReadDone(bool ok) override;
  void OnDone() override;

 private:
  // What an executor does with what was read. One at a time, never while a message is read.
  using Step = absl::Status (UploadReactor::*)();

  void Begin();
  // The step that `message_`, or its absence, asks for; an error when it is wrong.
  absl::StatusOr<Step> Next(bool ok);
  absl::Status CheckPace() const;
  absl::Status TakeHeader();
  absl::Status AppendChunk();
  absl::Status StoreMesh();
  void Post(Step step) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Run(Step step) ABSL_LOCKS_EXCLUDED(mutex_);
  void OnIdle() ABSL_LOCKS_EXCLUDED(mutex_);
  void ReadNext() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  MeshSupport& support_;
  grpc::CallbackServerContext& context_;
  v1::UploadMeshResponse& response_;
  std::shared_ptr<UploadReactor> self_;  // Until OnDone().

  // Of whoever has the turn: the reaction to a message, then the step.
  v1::UploadMeshRequest message_;
  bool has_header_ = false;
  MeshUpload upload_;
  std::unique_ptr<BlobWriter> writer_;
  bool stored_ = false;  // The response is ready.
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::optional<UploadSlots::Slot> slot_;  // Until OnDone().

  Mutex mutex_;
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<Call> call_ ABSL_GUARDED_BY(mutex_);  // Until OnDone().
  std::unique_ptr<IdleTimer> idle_;
};

}  // namespace ccst::server
