#include "server/rpc/rpc_executor.h"

#include "core/base/status.h"
#include "server/base/without_throwing.h"

namespace ccst::server {

absl::Status ExecutorFull() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                   "too many calls wait for the server's disk; try again later");
}

absl::Status RunStep(absl::FunctionRef<absl::Status()> step) {
  return WithoutThrowing("the call", step);
}

}  // namespace ccst::server
