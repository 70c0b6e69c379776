#include "core/base/printable_text.h"

#include <string>

#include <gtest/gtest.h>

namespace ccst {
namespace {

using std::string_literals::operator""s;

TEST(PrintableText, OrdinaryTextStays) {
  for (const std::string& text :
       {""s, "a mesh.ply"s, "C:\\meshes"s, "Prüfkörper 網格 \U0001F600"s, " two  words "s}) {
    EXPECT_EQ(PrintableText(text), text);
  }
}

TEST(PrintableText, ControlCharactersBecomeEscapes) {
  EXPECT_EQ(PrintableText("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(PrintableText("\x1b[2J\x1b]0;title\x07"), "\\u001b[2J\\u001b]0;title\\u0007");
  EXPECT_EQ(PrintableText("\0\x7f"s), "\\u0000\\u007f");
  // CSI and NEL as one character each, which terminals obey in UTF-8.
  EXPECT_EQ(PrintableText("\xc2\x9b"
                          "31m\xc2\x85"),
            "\\u009b31m\\u0085");
}

TEST(PrintableText, EveryControlCharacterOfOneByteIsEscaped) {
  for (int code = 0; code < 0x20; ++code) {
    const std::string shown = PrintableText(std::string(1, static_cast<char>(code)));
    EXPECT_EQ(shown.front(), '\\') << code;
    EXPECT_GE(shown.size(), 2u) << code;
  }
}

TEST(PrintableText, SeparatorsAndDirectionsBecomeEscapes) {
  EXPECT_EQ(PrintableText("a\xe2\x80\xa8g\xe2\x80\xa9"), "a\\u2028g\\u2029");
  EXPECT_EQ(PrintableText("\xe2\x80\xaetxt.exe\xe2\x81\xa6"), "\\u202etxt.exe\\u2066");
}

TEST(PrintableText, BytesThatAreNoUtf8BecomeEscapes) {
  EXPECT_EQ(PrintableText("\xff\xfe"), "\\xff\\xfe");
  EXPECT_EQ(PrintableText("\xc3"), "\\xc3");                             // Cut off.
  EXPECT_EQ(PrintableText("\xc0\x9b"), "\\xc0\\x9b");                    // Longer than need be.
  EXPECT_EQ(PrintableText("\xe0\x82\x9b"), "\\xe0\\x82\\x9b");           // Likewise.
  EXPECT_EQ(PrintableText("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // Half of a pair.
  EXPECT_EQ(PrintableText("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // Beyond Unicode.
  EXPECT_EQ(PrintableText("\x9b"), "\\x9b");  // CSI of terminals without UTF-8.
}

TEST(PrintableText, KeepsWhatItIsTold) {
  EXPECT_EQ(PrintableText("{\n\t\x1b\n}", "\n"), "{\n\\t\\u001b\n}");
}

TEST(PrintableExcerpt, ShortTextIsWhole) {
  EXPECT_EQ(PrintableExcerpt("12345", 5), "12345");
  EXPECT_EQ(PrintableExcerpt("\n\n", 4), "\\n\\n");
}

TEST(PrintableExcerpt, LongTextIsCutAtAWholeCharacter) {
  EXPECT_EQ(PrintableExcerpt("1234567", 6), "123...");
  EXPECT_EQ(PrintableExcerpt("aüüüü", 6), "aü...");
  EXPECT_EQ(PrintableExcerpt("a\x1b\x1b\x1b", 12), "a\\u001b...");
  EXPECT_EQ(PrintableExcerpt(std::string(1'000'000, 'x'), 3), "...");
}

}  // namespace
}  // namespace ccst
