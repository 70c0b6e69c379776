#include "server/base/without_throwing.h"

#include <exception>
#include <new>
#include <string>

#include "core/base/status.h"

namespace ccst::server {

absl::Status CaughtError(std::string_view what) {
  const std::string who(what);
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                     who +
                         " needs more memory than there is; ask for fewer samples or send a "
                         "smaller mesh");
  } catch (const std::exception& e) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                     who + " broke: " + e.what());
  } catch (...) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal, who + " broke");
  }
}

}  // namespace ccst::server
