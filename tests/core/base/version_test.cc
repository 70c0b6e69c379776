#include "core/base/version.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(Version, ProjectVersionIsSemantic) {
  EXPECT_THAT(std::string(ProjectVersion()),
              testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+(-[0-9A-Za-z.-]+)?"));
}

TEST(Version, SourceRevisionIsNeverEmpty) { EXPECT_FALSE(SourceRevision().empty()); }

}  // namespace
}  // namespace ccst
