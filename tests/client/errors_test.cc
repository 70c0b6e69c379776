#include "client/cli/errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ccst/v1/error.pb.h"
#include "client/cli/exit_code.h"
#include "core/base/status.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ExitCode, FollowsTheContract) {
  EXPECT_EQ(ExitCodeFor(absl::OkStatus()), 0);
  EXPECT_EQ(ExitCodeFor(absl::InvalidArgumentError("")), 2);
  EXPECT_EQ(ExitCodeFor(absl::FailedPreconditionError("")), 2);
  EXPECT_EQ(ExitCodeFor(absl::NotFoundError("")), 2);
  EXPECT_EQ(ExitCodeFor(absl::PermissionDeniedError("")), 2);
  EXPECT_EQ(ExitCodeFor(absl::UnimplementedError("")), 2);
  EXPECT_EQ(ExitCodeFor(absl::ResourceExhaustedError("")), 2);
  EXPECT_EQ(ExitCodeFor(absl::InternalError("")), 3);
  EXPECT_EQ(ExitCodeFor(absl::UnknownError("")), 3);
  EXPECT_EQ(ExitCodeFor(absl::DataLossError("")), 3);
  EXPECT_EQ(ExitCodeFor(absl::CancelledError("")), 4);
  EXPECT_EQ(ExitCodeFor(absl::UnavailableError("")), 5);
  EXPECT_EQ(ExitCodeFor(absl::DeadlineExceededError("")), 5);
}

TEST(ExitCode, TellsAFullQueueFromAFailedJob) {
  const auto code = absl::StatusCode::kResourceExhausted;
  EXPECT_EQ(ExitCodeFor(MakeError(code, ErrorReason::kQueueFull, "")), 2);
  EXPECT_EQ(ExitCodeFor(MakeError(code, ErrorReason::kOutOfMemory, "")), 3);
}

// Not the deadline of a call, which says that the server cannot be reached.
TEST(ExitCode, OfATimeLimitIsThatOfAFailedJob) {
  const absl::Status status =
      MakeError(absl::StatusCode::kDeadlineExceeded, ErrorReason::kTimeLimitExceeded, "too slow");
  EXPECT_EQ(ExitCodeFor(status), 3);
  EXPECT_EQ(ErrorText(status, "here:1"), "too slow");
}

TEST(ErrorText, KeepsWhatTheServerSays) {
  const absl::Status status = MakeError(absl::StatusCode::kFailedPrecondition,
                                        ErrorReason::kMeshNotManifold, "edge 3-7 has three faces");
  EXPECT_EQ(ErrorText(status, "here:1"), "edge 3-7 has three faces");
}

TEST(ErrorText, SaysWhatToDoWhenNoServerIsThere) {
  const std::string text = ErrorText(absl::UnavailableError("refused"), "here:1");
  EXPECT_THAT(text, HasSubstr("here:1"));
  EXPECT_THAT(text, HasSubstr("refused"));
  EXPECT_THAT(text, HasSubstr("--local"));
}

TEST(ErrorText, SaysWhenToTryAgain) {
  absl::Status status = MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining, "going");
  v1::RetryAdvice advice;
  *advice.mutable_retry_delay() = DurationToProto(1.5);
  SetDetail(advice, status);
  const std::string text = ErrorText(status, "here:1");
  EXPECT_THAT(text, HasSubstr("try again in 1.5 s"));
  EXPECT_THAT(text, Not(HasSubstr("cannot reach")));
}

TEST(ErrorText, PointsOutSmallerUploads) {
  const absl::Status status = MakeError(absl::StatusCode::kInvalidArgument,
                                        ErrorReason::kLimitExceeded, "over max_inline_mesh_bytes");
  EXPECT_THAT(ErrorText(status, "here:1"), HasSubstr("--quantization-bits"));
}

TEST(PrintError, LeavesTheTerminalAlone) {
  ::testing::internal::CaptureStderr();
  PrintError(absl::InternalError("\x1b]0;pwned\x07\x1b[2J\xc2\x9b"
                                 "1m evil\nccst: all is well"),
             "here\x1b:1");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "ccst: \\u001b]0;pwned\\u0007\\u001b[2J\\u009b1m evil\\nccst: all is well\n");
}

TEST(PrintError, IsNoLongerThanAnybodyReads) {
  ::testing::internal::CaptureStderr();
  PrintError(absl::InternalError(std::string(4 << 20, 'x')), "");
  EXPECT_LT(::testing::internal::GetCapturedStderr().size(), 5000u);
}

}  // namespace
}  // namespace ccst::cli
