#include "server/rpc/rpc_executor.h"

#include <exception>
#include <new>
#include <string>

#include "core/base/status.h"

namespace ccst::server {

absl::Status ExecutorFull() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                   "too many calls wait for the server's disk; try again later");
}

absl::Status RunStep(absl::FunctionRef<absl::Status()> step) {
  try {
    return step();
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                     "the call needs more memory than there is");
  } catch (const std::exception& e) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                     std::string("the call broke: ") + e.what());
  }
}

}  // namespace ccst::server
