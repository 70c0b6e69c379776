#include "server/app/listen_address.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

using ::testing::HasSubstr;

TEST(ListenAddress, RightOnesAreTaken) {
  for (const std::string& text :
       {std::string("127.0.0.1:0"), std::string("127.0.0.1:65535"), std::string("0.0.0.0:50051"),
        std::string("[::]:0"), std::string("[::1]:50051"), std::string("[fe80::1%eth0]:1"),
        std::string("localhost:0"), std::string("a-b.example:7"), std::string("10.example:7"),
        std::string(63, 'a') + ".example:7"}) {
    const auto address = ParseListenAddress(text);
    ASSERT_TRUE(address.ok()) << text << " " << address.status();
    EXPECT_EQ(address->ToText(), text);
  }
  EXPECT_EQ(ParseListenAddress("[::1]:50051")->host, "::1");
  EXPECT_EQ(ParseListenAddress("[::1]:50051")->port, 50051);
}

TEST(ListenAddress, WrongOnesAreRefusedInWords) {
  for (const std::string& text : std::vector<std::string>{"",
                                                          "x",
                                                          ":",
                                                          ":0",
                                                          "127.0.0.1",
                                                          "127.0.0.1:",
                                                          "127.0.0.1:99999",
                                                          "127.0.0.1:65536",
                                                          "127.0.0.1:-1",
                                                          "127.0.0.1:+1",
                                                          "127.0.0.1: 1",
                                                          " 127.0.0.1:1",
                                                          "127.0.0.1:1 ",
                                                          "127.0.0.1:1x",
                                                          "127.0.0.1:0x1",
                                                          "127.0.0.1:000001",
                                                          "127.0.0.1:http",
                                                          "*:0",
                                                          "0:0",
                                                          "1:1",
                                                          "127.1:0",
                                                          "256.0.0.1:0",
                                                          "127.0.0.1.:0",
                                                          "127.0.0.1,0.0.0.0:0",
                                                          "127.0.0.1:0,0.0.0.0:0",
                                                          "127.0.0.1:0,9999:0",
                                                          "+0:0",
                                                          "::1:50051",
                                                          "[::1]",
                                                          "[]:1",
                                                          "[::1:1",
                                                          "::1]:1",
                                                          "[127.0.0.1]:1",
                                                          "[::g]:1",
                                                          "[::1%]:1",
                                                          "[::1%a b]:1",
                                                          "unix:run:1",
                                                          "dns:///a:1",
                                                          "ipv4:127.0.0.1:1",
                                                          "-a:1",
                                                          "a-:1",
                                                          "a..b:1",
                                                          ".a:1",
                                                          "a_b:1",
                                                          "a b:1",
                                                          "a\nb:1",
                                                          std::string(64, 'a') + ":1",
                                                          "\xc3\xb6:1",
                                                          std::string("127.0.0.1\0:1", 12)}) {
    const auto address = ParseListenAddress(text);
    EXPECT_EQ(GetErrorReason(address.status()), ErrorReason::kOptionInvalid) << text;
    EXPECT_THAT(std::string(address.status().message()), HasSubstr("HOST:PORT")) << text;
    EXPECT_EQ(address.status().message().find('\n'), std::string::npos);
  }
}

TEST(ListenAddress, KnowsAllAddressesOfTheMachine) {
  EXPECT_TRUE(ParseListenAddress("0.0.0.0:1")->is_any());
  EXPECT_TRUE(ParseListenAddress("[::]:1")->is_any());
  EXPECT_TRUE(ParseListenAddress("[0:0::0]:1")->is_any());
  EXPECT_FALSE(ParseListenAddress("127.0.0.1:1")->is_any());
  EXPECT_FALSE(ParseListenAddress("[::1]:1")->is_any());
  EXPECT_FALSE(ParseListenAddress("localhost:1")->is_any());
}

}  // namespace
}  // namespace ccst::server
