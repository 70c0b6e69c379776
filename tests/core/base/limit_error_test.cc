#include "core/base/limit_error.h"

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst {
namespace {

TEST(LimitError, QuotaMayFitLaterAndNamesItsLimit) {
  const absl::Status status = OverQuota({"max_watchers_per_job", 3, 4}, "four are too many");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kQuotaExceeded);
  EXPECT_EQ(status.message(), "four are too many");
  ASSERT_TRUE(GetPassedLimit(status).has_value());
  EXPECT_EQ(GetPassedLimit(status)->name, "max_watchers_per_job");
  EXPECT_EQ(GetPassedLimit(status)->value, 3);
  EXPECT_EQ(GetPassedLimit(status)->requested, 4);
}

TEST(LimitError, WhatNeverFitsIsInvalid) {
  const absl::Status status = OverLimit({"max_mesh_bytes", INT64_MAX, INT64_MIN}, "too large");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kLimitExceeded);
  ASSERT_TRUE(GetPassedLimit(status).has_value());
  EXPECT_EQ(GetPassedLimit(status)->value, INT64_MAX);
  EXPECT_EQ(GetPassedLimit(status)->requested, INT64_MIN);
}

TEST(LimitError, OtherErrorsNameNone) {
  EXPECT_FALSE(GetPassedLimit(absl::OkStatus()).has_value());
  EXPECT_FALSE(GetPassedLimit(absl::InternalError("broken")).has_value());
}

}  // namespace
}  // namespace ccst
