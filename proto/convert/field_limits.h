#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "absl/status/status.h"
#include "google/protobuf/message.h"
#include "proto/convert/violations.h"

namespace ccst {

/// Most digests in a `FindMissingMeshesRequest`, and labels of a job.
inline constexpr int kMaxDigests = 1000;
inline constexpr int kMaxLabels = 16;

/// How long a field of the API may be.
struct FieldLimit {
  std::string_view field;  ///< Full name, for example `ccst.v1.CreateJobRequest.request_id`.
  std::int64_t most = 0;   ///< Bytes of a text, entries of a list or map; 0: `advertised` says.
  /// The field of `ServerLimits` that has the limit, for what can be set. FromProto() checks these,
  /// which knows the values.
  std::string_view advertised = {};
  std::int64_t most_each = 0;  ///< Bytes of each text in a list of texts.
};

/// The limits of all strings, lists and maps in requests, and in what is stored and listed.
/// A test fails for a field of the API that is not here.
std::span<const FieldLimit> FieldLimits();

/// Adds to `violations` every field of `request` that is longer than FieldLimits() allow, however
/// deep inside, by its path. Cost O(fields that are set).
void CheckFieldLimits(const google::protobuf::Message& request, Violations& violations);

/// The same as INVALID_ARGUMENT REQUEST_INVALID; OK when nothing is too long.
absl::Status CheckFieldLimits(const google::protobuf::Message& request);

/// Cuts what is longer than FieldLimits() allow: texts at a character, lists after their last entry
/// that fits; maps stay as they are. For messages about to be sent, whose parts come from files and
/// from older versions.
void CutToFieldLimits(google::protobuf::Message& message);

}  // namespace ccst
