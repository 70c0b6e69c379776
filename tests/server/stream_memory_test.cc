#include "server/rpc/stream_memory.h"

#include <optional>

#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

TEST(StreamMemory, OneCallerDoesNotGetAll) {
  StreamMemory memory({.most_bytes = 400});
  std::optional<StreamMemory::Share> first = *memory.Take("ann", 200);
  const StreamMemory::Share second = *memory.Take("ann", 100);
  const absl::Status over = memory.Take("ann", 1).status();
  EXPECT_EQ(GetErrorReason(over), ErrorReason::kQuotaExceeded);
  EXPECT_EQ(GetPassedLimit(over)->name, "max_stream_bytes_per_caller");
  EXPECT_EQ(GetPassedLimit(over)->value, 300);
  EXPECT_EQ(GetPassedLimit(over)->requested, 301);
  const StreamMemory::Share third = *memory.Take("bob", 100);
  const absl::Status full = memory.Take("eve", 1).status();
  EXPECT_EQ(GetErrorReason(full), ErrorReason::kQueueFull);
  EXPECT_EQ(GetPassedLimit(full)->name, "max_stream_bytes");
  first.reset();
  EXPECT_TRUE(memory.Take("eve", 200).ok());
  EXPECT_TRUE(memory.Take("ann", 200).ok());
}

TEST(StreamMemory, WhatWasRefusedTakesNothing) {
  StreamMemory memory({.most_bytes = 400});
  EXPECT_FALSE(memory.Take("ann", 301).ok());
  EXPECT_TRUE(memory.Take("ann", 300).ok());
}

}  // namespace
}  // namespace ccst::server
