#include "server/auth/token.h"

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

// SHA-256 of "abc", FIPS 180-4.
constexpr char kAbcHash[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST(Token, LineHoldsTheHashAndNotTheToken) {
  EXPECT_EQ(TokenLine("alice", Scope::kFull, "abc"), std::string("alice full ") + kAbcHash);
  EXPECT_EQ(TokenLine("bob", Scope::kReadOnly, "abc"), std::string("bob read-only ") + kAbcHash);
}

TEST(Token, NewOnesAreLongAndDiffer) {
  const std::string a = *NewToken();
  EXPECT_EQ(a.size(), 5U + 64U);
  EXPECT_EQ(a.rfind("ccst_", 0), 0U);
  EXPECT_NE(a, *NewToken());
}

TEST(Token, LinesAreReadBack) {
  const auto entries = ParseTokens("# who\n\n" + TokenLine("alice", Scope::kFull, "a") + "\r\n  " +
                                   TokenLine("alice", Scope::kReadOnly, "b") + "\n");
  ASSERT_TRUE(entries.ok()) << entries.status();
  ASSERT_EQ(entries->size(), 2U);
  const Caller* a = FindCaller(*entries, "a");
  const Caller* b = FindCaller(*entries, "b");
  ASSERT_NE(a, nullptr);
  ASSERT_NE(b, nullptr);
  EXPECT_EQ(a->owner, "alice");
  EXPECT_EQ(a->scope, Scope::kFull);
  EXPECT_EQ(b->scope, Scope::kReadOnly);
  EXPECT_EQ(FindCaller(*entries, ""), nullptr);
  EXPECT_EQ(FindCaller(*entries, kAbcHash), nullptr);
}

TEST(Token, WrongLineIsNamedByItsNumberAlone) {
  const std::string good = TokenLine("a", Scope::kFull, "a");
  for (const std::string bad :
       {"secret", "a full", "a b full 00", "a most 00", "a full zz", "a full 00", "a/b full 00"}) {
    const auto entries = ParseTokens(good + "\n" + bad + "\n");
    EXPECT_EQ(GetErrorReason(entries.status()), ErrorReason::kOptionInvalid) << bad;
    const std::string message(entries.status().message());
    EXPECT_EQ(message.rfind("line 2: ", 0), 0U) << message;
    EXPECT_EQ(message.find("secret"), std::string::npos) << message;
  }
  EXPECT_FALSE(ParseTokens(good + "\n" + TokenLine("b", Scope::kFull, "a")).ok());
}

TEST(Token, NamesAreWords) {
  for (const char* name : {"alice", "a.b_c@d-e", "0"}) EXPECT_TRUE(IsTokenName(name)) << name;
  for (const std::string& name :
       {std::string(), std::string("a b"), std::string("a:b"), std::string("a\n"),
        std::string("\xC3\xA4"), std::string(65, 'a')}) {
    EXPECT_FALSE(IsTokenName(name)) << name;
  }
}

}  // namespace
}  // namespace ccst::server
