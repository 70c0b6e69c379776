#include "server/base/without_throwing.h"

#include <new>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "absl/status/statusor.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

TEST(WithoutThrowing, WhatIsReturnedIsReturned) {
  EXPECT_EQ(*WithoutThrowing("the call", [] { return absl::StatusOr<int>(7); }), 7);
  const absl::Status error = absl::NotFoundError("nothing");
  EXPECT_EQ(WithoutThrowing("the call", [&] { return error; }), error);
}

TEST(WithoutThrowing, MemoryThatIsNotThereIsAnErrorOfItsOwn) {
  const absl::Status status =
      WithoutThrowing("the call", []() -> absl::Status { throw std::bad_alloc(); });
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kOutOfMemory);
  EXPECT_EQ(status.message().rfind("the call needs more memory", 0), 0U);
}

TEST(WithoutThrowing, WhateverElseIsThrownIsAFaultOfTheProgram) {
  const auto known = WithoutThrowing(
      "the call", []() -> absl::StatusOr<int> { throw std::runtime_error("no reason"); });
  EXPECT_EQ(GetErrorReason(known.status()), ErrorReason::kInternal);
  EXPECT_EQ(known.status().message(), "the call broke: no reason");
  const absl::Status unknown = WithoutThrowing("the call", []() -> absl::Status { throw 7; });
  EXPECT_EQ(unknown.code(), absl::StatusCode::kInternal);
  EXPECT_EQ(unknown.message(), "the call broke");
}

}  // namespace
}  // namespace ccst::server
