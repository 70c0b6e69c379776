#include "proto/convert/violations.h"

#include "proto/convert/status.h"

namespace ccst {

void Violations::Add(const std::string& field, const std::string& description, ErrorReason reason) {
  if (fields_.field_violations_size() == kMost) {
    ++left_out_;
    return;
  }
  auto* violation = fields_.add_field_violations();
  violation->set_field(field);
  violation->set_description(description);
  if (!reason_.has_value()) reason_ = reason;
}

void Violations::AddLimit(const std::string& field, const std::string& limit,
                          std::int64_t limit_value, std::int64_t requested_value) {
  Add(field,
      "is " + std::to_string(requested_value) + ", must be at most " + std::to_string(limit_value) +
          " (" + limit + ")",
      ErrorReason::kLimitExceeded);
  if (limit_.has_value()) return;
  limit_.emplace();
  limit_->set_limit(limit);
  limit_->set_limit_value(limit_value);
  limit_->set_requested_value(requested_value);
}

absl::Status Violations::ToStatus() const {
  if (!reason_.has_value()) return absl::OkStatus();
  std::string message;
  for (const auto& violation : fields_.field_violations()) {
    if (!message.empty()) message += "; ";
    message += violation.field() + ": " + violation.description();
  }
  if (left_out_ > 0) message += "; and " + std::to_string(left_out_) + " more";
  absl::Status status = MakeError(absl::StatusCode::kInvalidArgument, *reason_, message);
  SetDetail(fields_, status);
  if (limit_.has_value()) SetDetail(*limit_, status);
  return status;
}

}  // namespace ccst
