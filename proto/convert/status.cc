#include "proto/convert/status.h"

#include <string_view>

#include "absl/strings/cord.h"
#include "absl/strings/match.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "proto/convert/error_reasons.h"

namespace ccst {
namespace {

constexpr char kTypePrefix[] = "type.googleapis.com/";

std::string TypeUrl(const google::protobuf::Message& message) {
  return kTypePrefix + message.GetDescriptor()->full_name();
}

std::string ReasonOf(const absl::Status& status) {
  if (const auto reason = GetErrorReason(status)) return std::string(ErrorReasonName(*reason));
  const ErrorReason fallback = status.code() == absl::StatusCode::kCancelled
                                   ? ErrorReason::kCancelled
                                   : ErrorReason::kInternal;
  return std::string(ErrorReasonName(fallback));
}

}  // namespace

std::string CutAtCharacter(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return std::string(text.substr(0, end));
}

void SetDetail(const google::protobuf::Message& detail, absl::Status& status) {
  status.SetPayload(TypeUrl(detail), absl::Cord(detail.SerializeAsString()));
}

bool GetDetail(const absl::Status& status, google::protobuf::Message& detail) {
  const auto payload = status.GetPayload(TypeUrl(detail));
  return payload.has_value() && detail.ParseFromString(std::string(*payload));
}

v1::Status ToProto(const absl::Status& status) {
  v1::Status message;
  message.set_code(static_cast<int>(status.code()));
  message.set_message(
      CutAtCharacter({status.message().data(), status.message().size()}, kMaxStatusMessageBytes));
  v1::ErrorInfo info;
  if (!GetDetail(status, info)) {
    info.set_reason(ReasonOf(status));
    info.set_domain(kErrorDomain);
  }
  message.add_details()->PackFrom(info);
  if (const auto passed = GetPassedLimit(status)) {
    v1::LimitViolation violation;
    violation.set_limit(passed->name);
    violation.set_limit_value(passed->value);
    violation.set_requested_value(passed->requested);
    message.add_details()->PackFrom(violation);
  }
  const std::string info_url = TypeUrl(info);
  status.ForEachPayload([&](absl::string_view url, const absl::Cord& value) {
    if (url == info_url || !absl::StartsWith(url, kTypePrefix)) return;
    google::protobuf::Any* detail = message.add_details();
    detail->set_type_url(std::string(url));
    detail->set_value(std::string(value));
  });
  return message;
}

absl::Status FromProto(const v1::Status& status) {
  const auto code = static_cast<absl::StatusCode>(status.code());
  v1::ErrorInfo info;
  for (const google::protobuf::Any& detail : status.details()) detail.UnpackTo(&info);
  const auto reason = info.domain() == kErrorDomain ? FindErrorReason(info.reason()) : std::nullopt;
  absl::Status result = reason.has_value() ? MakeError(code, *reason, status.message())
                                           : absl::Status(code, status.message());
  for (const google::protobuf::Any& detail : status.details()) {
    result.SetPayload(detail.type_url(), absl::Cord(detail.value()));
  }
  return result;
}

}  // namespace ccst
