#include "core/io/io_errors.h"

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"

namespace ccst::io {

absl::Status WithPrefix(const absl::Status& status, const std::string& prefix) {
  if (status.ok()) return status;
  absl::Status result(status.code(), absl::StrCat(prefix, status.message()));
  status.ForEachPayload([&result](absl::string_view url, const absl::Cord& payload) {
    result.SetPayload(url, payload);
  });
  return result;
}

}  // namespace ccst::io
