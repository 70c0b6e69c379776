#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "ccst/v1/error.pb.h"
#include "google/protobuf/message.h"

namespace ccst {

/// `ErrorInfo.domain` of every error of ours.
inline constexpr char kErrorDomain[] = "ccst.v1";

/// Longest `Status.message` sent, in bytes; longer ones are cut at a character boundary.
inline constexpr std::size_t kMaxStatusMessageBytes = 1024;

/// `text` without what is beyond `most` bytes, cut between two characters of UTF-8.
std::string CutAtCharacter(std::string_view text, std::size_t most);

/// Attaches `detail` to `status`, which must not be OK; a detail of the same type is replaced.
/// ToProto() puts it into `Status.details`.
void SetDetail(const google::protobuf::Message& detail, absl::Status& status);

/// Reads the detail of the type of `detail` into it; false when there is none.
bool GetDetail(const absl::Status& status, google::protobuf::Message& detail);

/// The wire form of a status that is not OK: code, message, an `ErrorInfo` with the reason
/// inside (CANCELLED or INTERNAL, by the code, for a status without one), a `LimitViolation` where
/// the status names a limit that was passed, and the details set.
v1::Status ToProto(const absl::Status& status);

/// The reverse. Details that are not `ErrorInfo` are kept for GetDetail(); a reason this version
/// does not know leaves GetErrorReason() empty, and its `ErrorInfo` readable by GetDetail().
absl::Status FromProto(const v1::Status& status);

}  // namespace ccst
