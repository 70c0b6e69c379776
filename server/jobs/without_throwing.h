#pragma once

#include <exception>
#include <functional>
#include <new>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/status.h"

namespace ccst::server {

/// What `compute` returns; what it throws as RESOURCE_EXHAUSTED OUT_OF_MEMORY or INTERNAL INTERNAL.
template <typename T>
absl::StatusOr<T> WithoutThrowing(const std::function<absl::StatusOr<T>()>& compute) {
  try {
    return compute();
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                     "the computation needs more memory than there is; ask for fewer samples or "
                     "send a smaller mesh");
  } catch (const std::exception& e) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                     std::string("the computation broke: ") + e.what());
  } catch (...) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal, "the computation broke");
  }
}

}  // namespace ccst::server
