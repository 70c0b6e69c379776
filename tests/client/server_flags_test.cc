#include "client/cli/server_flags.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "core/base/status.h"
#include "tests/server/temp_folder.h"

namespace ccst::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using std::string_literals::operator""s;

class TokenFile : public ::testing::Test {
 protected:
  TokenFile() { unsetenv("CCST_TOKEN"); }
  ~TokenFile() override { unsetenv("CCST_TOKEN"); }

  absl::Status Connect(const std::string& text) {
    ServerFlags flags;
    flags.token_file = folder_.Write("token", text);
    return ConnectTo("127.0.0.1:1", flags).status();
  }

  server::TempFolder folder_;
};

TEST_F(TokenFile, IsReadAsEditorsWriteIt) {
  for (const std::string& text : {"ccst_abc"s, "ccst_abc\n"s, "ccst_abc\r\n"s, "  ccst_abc \t\n\n"s,
                                  "\xef\xbb\xbf"
                                  "ccst_abc\r\n"s}) {
    EXPECT_TRUE(Connect(text).ok()) << text;
  }
}

TEST_F(TokenFile, ThatHoldsNoTokenIsRefusedInWords) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "is empty"},
      {" \r\n", "is empty"},
      {"\xef\xbb\xbf", "is empty"},
      {"one\ntwo\n", "has several lines"},
      {"one\rtwo", "has several lines"},
      {"secret\0b"s, "holds no token"},
      {"secret b", "holds no token"},
      {"secrét", "holds no token"},
      {"secret\x7f", "holds no token"},
      {"secret\x1b[2J", "holds no token"},
      {"\xff\xfes\0e\0c\0"s, "is UTF-16"},
      {"\xfe\xff\0s\0e"s, "is UTF-16"},
      {std::string(4097, 'a'), "holds no token"},
      {std::string((1 << 20) + 1, 'a'), "more than 1048576 bytes"},
  };
  for (const auto& [text, words] : wrong) {
    const absl::Status status = Connect(text);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << words;
    EXPECT_THAT(std::string(status.message()), HasSubstr(words));
    EXPECT_THAT(std::string(status.message()), HasSubstr(folder_.Path("token")));
    EXPECT_THAT(std::string(status.message()), Not(HasSubstr("secr")));
  }
}

TEST_F(TokenFile, VariableIsHeldToTheSame) {
  setenv("CCST_TOKEN", "a\r\nx: y", 1);
  const absl::Status status = ConnectTo("127.0.0.1:1", {}).status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kOptionInvalid);
  EXPECT_THAT(std::string(status.message()), HasSubstr("CCST_TOKEN: has several lines"));
  setenv("CCST_TOKEN", "", 1);
  EXPECT_TRUE(ConnectTo("127.0.0.1:1", {}).ok());
}

}  // namespace
}  // namespace ccst::cli
