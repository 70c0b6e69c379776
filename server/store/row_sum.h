#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/time/time.h"
#include "core/base/sha256.h"

namespace ccst::server {

/// A sum of the values of a row, by which damage is seen that leaves the pages of the database
/// whole. Equal values in the same order give equal sums.
class RowSum {
 public:
  RowSum& Add(std::string_view text);
  RowSum& Add(std::int64_t number);
  /// As records keep it, in microseconds.
  RowSum& Add(absl::Time time) { return Add(absl::ToUnixMicros(time)); }
  RowSum& Add(const std::optional<absl::Time>& time);

  /// 16 hexadecimal digits; once.
  std::string Finish();

 private:
  Sha256 hash_;
};

}  // namespace ccst::server
