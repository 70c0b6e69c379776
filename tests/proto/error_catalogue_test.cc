#include <fstream>
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

}  // namespace
}  // namespace ccst
