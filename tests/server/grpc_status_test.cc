#include "server/rpc/grpc_status.h"

#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

v1::Status Details(const grpc::Status& status) {
  v1::Status message;
  EXPECT_TRUE(message.ParseFromString(status.error_details()));
  return message;
}

TEST(ToGrpcStatus, OkHasNoDetails) {
  EXPECT_TRUE(ToGrpcStatus(absl::OkStatus()).ok());
  EXPECT_TRUE(ToGrpcStatus(absl::OkStatus()).error_details().empty());
}

TEST(ToGrpcStatus, DetailsRepeatCodeAndMessage) {
  const grpc::Status status = ToGrpcStatus(
      MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty, "no faces"));
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(status.error_message(), "no faces");
  EXPECT_EQ(Details(status).code(), 3);
  v1::ErrorInfo info;
  ASSERT_TRUE(Unpack(Details(status), info));
  EXPECT_EQ(info.reason(), "MESH_EMPTY");
  v1::RetryAdvice advice;
  EXPECT_FALSE(Unpack(Details(status), advice));
}

TEST(ToGrpcStatus, WhatMayWorkLaterSaysWhen) {
  for (const auto reason : {ErrorReason::kQueueFull, ErrorReason::kDraining,
                            ErrorReason::kQuotaExceeded, ErrorReason::kStorageFull}) {
    v1::RetryAdvice advice;
    EXPECT_TRUE(Unpack(
        Details(ToGrpcStatus(MakeError(absl::StatusCode::kUnavailable, reason, "later"))), advice));
  }
}

TEST(ToGrpcStatus, QuotaSaysItsLimitAndWhenToComeAgain) {
  const v1::Status details =
      Details(ToGrpcStatus(OverQuota({"max_watchers_per_job", 3, 4}, "four are too many")));
  EXPECT_EQ(details.code(), static_cast<int>(grpc::StatusCode::RESOURCE_EXHAUSTED));
  v1::LimitViolation violation;
  ASSERT_TRUE(Unpack(details, violation));
  EXPECT_EQ(violation.limit(), "max_watchers_per_job");
  EXPECT_EQ(violation.limit_value(), 3);
  EXPECT_EQ(violation.requested_value(), 4);
  v1::RetryAdvice advice;
  EXPECT_TRUE(Unpack(details, advice));
}

TEST(ToGrpcStatus, WhatNeverFitsIsNotToldToComeAgain) {
  const v1::Status details =
      Details(ToGrpcStatus(OverLimit({"max_mesh_bytes", 3, 4}, "four are too many")));
  EXPECT_EQ(details.code(), static_cast<int>(grpc::StatusCode::INVALID_ARGUMENT));
  v1::LimitViolation violation;
  ASSERT_TRUE(Unpack(details, violation));
  EXPECT_EQ(violation.limit(), "max_mesh_bytes");
  v1::RetryAdvice advice;
  EXPECT_FALSE(Unpack(details, advice));
}

}  // namespace
}  // namespace ccst::server
