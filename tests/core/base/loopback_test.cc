#include "core/base/loopback.h"

#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(Loopback, IsThisMachineOnly) {
  for (const char* address : {"127.0.0.1:0", "127.8.9.10:50051", "localhost:1", "[::1]:50051",
                              "localhost", "127.0.0.1", "[::1]"}) {
    EXPECT_TRUE(IsLoopback(address)) << address;
  }
  for (const char* address :
       {"0.0.0.0:0", "[::]:0", "10.0.0.1:1", "128.0.0.1:1", "localhost.example.org:1", "127.1:1",
        "::1", "", ":50051", "127.0.0.1.example.org:1", "[::1", "[fe80::1]:1", "1270.0.0.1:1"}) {
    EXPECT_FALSE(IsLoopback(address)) << address;
  }
}

}  // namespace
}  // namespace ccst
