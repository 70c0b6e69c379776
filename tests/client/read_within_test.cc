#include "client/cli/read_within.h"

#include <chrono>
#include <future>
#include <memory>

#include <gtest/gtest.h>

#include "client/cli/mesh_input.h"
#include "core/base/status.h"

namespace ccst::cli {
namespace {

using Clock = ccst::Interrupt::Clock;

TEST(ReadWithin, WithoutADeadlineIsTheReadersResult) {
  const auto input = ReadWithin<MeshInput>({}, []() -> absl::StatusOr<MeshInput> {
    MeshInput read;
    read.max_move = 3.0;
    return read;
  });
  ASSERT_TRUE(input.ok());
  EXPECT_EQ(input->max_move, 3.0);
}

TEST(ReadWithin, InTimeIsTheReadersResult) {
  const auto deadline = Clock::now() + std::chrono::hours(1);
  const auto refused = ReadWithin<MeshInput>(deadline, []() -> absl::StatusOr<MeshInput> {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshUnreadable, "no mesh");
  });
  EXPECT_EQ(refused.status().message(), "no mesh");
}

TEST(ReadWithin, LateReaderIsLeftBehind) {
  const auto go = std::make_shared<std::promise<void>>();
  const auto late = ReadWithin<MeshInput>(Clock::now() + std::chrono::milliseconds(5),
                                          [go]() -> absl::StatusOr<MeshInput> {
                                            go->get_future().wait();
                                            return MeshInput();
                                          });
  EXPECT_EQ(GetErrorReason(late.status()), ErrorReason::kTimeLimitExceeded) << late.status();
  go->set_value();
}

}  // namespace
}  // namespace ccst::cli
