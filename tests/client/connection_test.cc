#include "client/lib/connection.h"

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst {
namespace {

absl::Status Open(const Connection& connection) { return OpenChannel(connection).status(); }

TEST(Connection, TokenStaysOnThisMachineUnlessEncryptedOrAllowed) {
  EXPECT_TRUE(Open({.address = "127.0.0.1:1", .token = "t"}).ok());
  const absl::Status refused = Open({.address = "192.0.2.1:1", .token = "secret-t"});
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kOptionInvalid);
  EXPECT_NE(refused.message().find("192.0.2.1:1"), std::string::npos);
  EXPECT_EQ(refused.message().find("secret-t"), std::string::npos);
  EXPECT_TRUE(Open({.address = "192.0.2.1:1", .ca = "PEM", .token = "t"}).ok());
  EXPECT_TRUE(Open({.address = "192.0.2.1:1", .token = "t", .insecure = true}).ok());
  EXPECT_TRUE(Open({.address = "192.0.2.1:1"}).ok());
}

TEST(Connection, TokenThatCannotBeSentIsRefused) {
  for (const char* token : {"a b", "a\nb", "\xc3\xb6",
                            "\xef\xbb\xbf"
                            "a",
                            "a\x7f"}) {
    const absl::Status refused = Open({.address = "127.0.0.1:1", .token = token});
    EXPECT_EQ(GetErrorReason(refused), ErrorReason::kOptionInvalid) << token;
    EXPECT_EQ(refused.message().find(token), std::string::npos);
  }
}

TEST(Connection, CertificateNeedsKeyAndAuthority) {
  EXPECT_TRUE(
      Open({.address = "192.0.2.1:1", .ca = "PEM", .certificate = "PEM", .key = "PEM"}).ok());
  for (const Connection& wrong :
       {Connection{.ca = "PEM", .certificate = "PEM"}, Connection{.ca = "PEM", .key = "PEM"},
        Connection{.certificate = "PEM", .key = "PEM"}}) {
    EXPECT_EQ(GetErrorReason(Open(wrong)), ErrorReason::kOptionInvalid);
  }
}

}  // namespace
}  // namespace ccst
