#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst {
namespace {

std::set<std::string> ReasonsInCode() {
  std::set<std::string> reasons;
  for (int i = 0;; ++i) {
    const std::string name(ErrorReasonName(static_cast<ErrorReason>(i)));
    if (name == "UNKNOWN") return reasons;
    reasons.insert(name);
  }
}

TEST(ErrorCatalogue, AgreesWithTheCode) {
  std::ifstream file(CCST_ERRORS_MD);
  ASSERT_TRUE(file.is_open()) << CCST_ERRORS_MD;
  const std::regex row(R"(^\| `([A-Z_]+)` \| ([A-Z_, ]+) \| .+\|$)");
  std::set<std::string> documented;
  for (std::string line; std::getline(file, line);) {
    if (std::smatch match; std::regex_match(line, match, row)) {
      EXPECT_TRUE(documented.insert(match[1]).second) << match[1] << " is listed twice";
    }
  }
  EXPECT_EQ(documented, ReasonsInCode());
}

// The whole text of a file.
std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A quota that does not say which it is cannot be acted on. Everything that raises one goes through
// OverQuota(), which wants the limit.
TEST(ErrorCatalogue, QuotaIsOnlyRaisedWithItsLimit) {
  const std::regex raised(R"(ErrorReason::kQuotaExceeded\s*,(?!\s*"QUOTA_EXCEEDED"))");
  const std::filesystem::path sources = CCST_SOURCES;
  int files = 0;
  for (const char* const room : {"core", "proto", "server"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(sources / room)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cc" && extension != ".h") continue;
      ++files;
      if (entry.path().filename() == "limit_error.cc") continue;
      EXPECT_FALSE(std::regex_search(TextOf(entry.path()), raised)) << entry.path();
    }
  }
  EXPECT_GT(files, 100);
}

// Without a limit that a caller can look up, LIMIT_EXCEEDED leaves it guessing.
TEST(ErrorCatalogue, ServerRaisesLimitsOnlyWithTheirNames) {
  const std::regex raised(R"(kInvalidArgument,\s*ErrorReason::kLimitExceeded)");
  for (const auto& entry : std::filesystem::recursive_directory_iterator(
           std::filesystem::path(CCST_SOURCES) / "server")) {
    if (entry.path().extension() != ".cc") continue;
    EXPECT_FALSE(std::regex_search(TextOf(entry.path()), raised)) << entry.path();
  }
}

}  // namespace
}  // namespace ccst
