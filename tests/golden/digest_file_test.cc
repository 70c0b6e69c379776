#include "tests/golden/digest_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ccst::golden {
namespace {

using testing::HasSubstr;

const DigestFile kRecorded = {.revision = 3, .digests = {{"a", "11"}, {"b", "22"}}};

TEST(DigestFile, IsReadAsWritten) {
  const absl::StatusOr<DigestFile> file = ParseDigestFile(FormatDigestFile(kRecorded));
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->revision, 3);
  EXPECT_EQ(file->digests, kRecorded.digests);
}

TEST(DigestFile, BrokenLinesAreRefused) {
  EXPECT_FALSE(ParseDigestFile("").ok());
  EXPECT_FALSE(ParseDigestFile("a 11\n").ok());
  EXPECT_FALSE(ParseDigestFile("algorithm_revision three\n").ok());
  EXPECT_FALSE(ParseDigestFile("algorithm_revision 3\nalgorithm_revision 4\n").ok());
  EXPECT_FALSE(ParseDigestFile("algorithm_revision 3\na 11 12\n").ok());
  EXPECT_FALSE(ParseDigestFile("algorithm_revision 3\na 11\na 11\n").ok());
}

TEST(FindSilentChange, ChangedSamplesOfOneRevisionAreNamed) {
  DigestFile now = kRecorded;
  EXPECT_EQ(FindSilentChange(kRecorded, now), "");
  now.digests["b"] = "33";
  EXPECT_THAT(FindSilentChange(kRecorded, now), HasSubstr("'b' have changed, from 22 to 33"));
}

TEST(FindSilentChange, ChangedSamplesOfTheNextRevisionAreWanted) {
  EXPECT_EQ(FindSilentChange(kRecorded, {.revision = 4, .digests = {{"a", "33"}}}), "");
}

TEST(FindSilentChange, AnEarlierRevisionIsRefused) {
  EXPECT_THAT(FindSilentChange(kRecorded, {.revision = 2, .digests = {}}), HasSubstr("went back"));
}

TEST(FindSilentChange, ANewRequestIsNoChange) {
  DigestFile now = kRecorded;
  now.digests["c"] = "33";
  EXPECT_EQ(FindSilentChange(kRecorded, now), "");
}

}  // namespace
}  // namespace ccst::golden
