#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "ccst/v1/error.pb.h"
#include "core/base/status.h"

namespace ccst {

/// Collects everything that is wrong with a request, so that the caller learns all of it at once;
/// of very many the first kMost, which is what a trailer holds.
class Violations {
 public:
  static constexpr int kMost = 20;

  /// `field` is a path from the request's root; `description` says what a right value looks like.
  void Add(const std::string& field, const std::string& description,
           ErrorReason reason = ErrorReason::kOptionInvalid);

  /// A value over an advertised limit. The first one becomes the `LimitViolation`.
  void AddLimit(const std::string& field, const std::string& limit, std::int64_t limit_value,
                std::int64_t requested_value);

  /// OK when nothing was added; else INVALID_ARGUMENT whose reason is that of the first
  /// violation, with `FieldViolations` and, where a limit was passed, `LimitViolation`.
  absl::Status ToStatus() const;

 private:
  v1::FieldViolations fields_;
  std::optional<v1::LimitViolation> limit_;
  std::optional<ErrorReason> reason_;
  int left_out_ = 0;
};

}  // namespace ccst
