#include "core/io/text_cursor.h"

#include <gtest/gtest.h>

namespace ccst::io {
namespace {

TEST(TextCursor, TokensAndLinesWithEveryLineEnd) {
  TextCursor cursor("a b\nc\r\nd\re", {});
  EXPECT_EQ(cursor.Token(), "a");
  EXPECT_EQ(cursor.line(), 1);
  EXPECT_EQ(cursor.TokenOnLine(), "b");
  EXPECT_EQ(cursor.TokenOnLine(), "");
  EXPECT_EQ(cursor.Token(), "c");
  EXPECT_EQ(cursor.line(), 2);
  EXPECT_EQ(cursor.Token(), "d");
  EXPECT_EQ(cursor.line(), 3);
  EXPECT_EQ(cursor.Token(), "e");
  EXPECT_EQ(cursor.line(), 4);
  EXPECT_EQ(cursor.Token(), "");
  EXPECT_TRUE(cursor.AtEnd());
}

TEST(TextCursor, CommentsEndTokensAndLines) {
  TextCursor cursor("a#b c\n#\n  # d\ne", {.comment = '#'});
  EXPECT_EQ(cursor.Token(), "a");
  EXPECT_EQ(cursor.TokenOnLine(), "");
  EXPECT_EQ(cursor.Token(), "e");
  EXPECT_EQ(cursor.line(), 4);
}

TEST(TextCursor, BackslashJoinsLinesWhereAsked) {
  TextCursor joined("a\\\nb \\\r\nc\nd", {.continuation = true});
  EXPECT_EQ(joined.TokenOnLine(), "a");
  EXPECT_EQ(joined.TokenOnLine(), "b");
  EXPECT_EQ(joined.TokenOnLine(), "c");
  EXPECT_EQ(joined.TokenOnLine(), "");
  EXPECT_EQ(joined.line(), 3);
  TextCursor skipped("a \\\n b\nc", {.continuation = true});
  skipped.SkipLine();
  EXPECT_EQ(skipped.Token(), "c");
  TextCursor plain("a\\\nb", {});
  EXPECT_EQ(plain.TokenOnLine(), "a\\");
}

TEST(TextCursor, RestOfLine) {
  TextCursor cursor("solid a name\nfacet", {});
  EXPECT_EQ(cursor.Token(), "solid");
  EXPECT_EQ(cursor.RestOfLine(), " a name");
  EXPECT_EQ(cursor.RestOfLine(), "facet");
  EXPECT_EQ(cursor.remaining(), 0u);
}

}  // namespace
}  // namespace ccst::io
