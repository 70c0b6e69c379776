#include "core/base/status.h"

#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace ccst {
namespace {

absl::StatusOr<int> Half(int value) {
  if (value % 2 != 0) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, "odd");
  }
  return value / 2;
}

absl::StatusOr<int> Quarter(int value) {
  CCST_ASSIGN_OR_RETURN(const int half, Half(value));
  CCST_ASSIGN_OR_RETURN(const int quarter, Half(half));
  return quarter;
}

absl::Status CheckQuarter(int value) {
  CCST_RETURN_IF_ERROR(Quarter(value).status());
  return absl::OkStatus();
}

TEST(Status, MadeErrorCarriesCodeMessageAndReason) {
  const absl::Status status =
      MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshNotManifold, "where");
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(status.message(), "where");
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kMeshNotManifold);
}

TEST(Status, StatusWithoutReasonHasNone) {
  EXPECT_EQ(GetErrorReason(absl::OkStatus()), std::nullopt);
  EXPECT_EQ(GetErrorReason(absl::InternalError("x")), std::nullopt);
}

TEST(Status, EveryReasonRoundTripsUnderADistinctName) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(ErrorReason::kInternal); ++i) {
    const auto reason = static_cast<ErrorReason>(i);
    const std::string name(ErrorReasonName(reason));
    EXPECT_FALSE(name.empty()) << i;
    EXPECT_EQ(name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_"), std::string::npos) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(GetErrorReason(MakeError(absl::StatusCode::kInternal, reason, "")), reason);
  }
}

TEST(Status, MacrosPassValuesAndErrorsOn) {
  EXPECT_EQ(*Quarter(12), 3);
  EXPECT_TRUE(CheckQuarter(12).ok());
  EXPECT_EQ(CheckQuarter(6).message(), "odd");
  EXPECT_EQ(GetErrorReason(Quarter(7).status()), ErrorReason::kOptionInvalid);
}

}  // namespace
}  // namespace ccst
