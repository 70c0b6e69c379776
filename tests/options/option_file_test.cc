#include "tests/options/option_file.h"

#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(OptionFile, IsWhatTheTableSays) {
  std::ifstream in(std::string(CCST_SOURCE_DIR "/") + kOptionFile);
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_EQ(text.str(), OptionFileText())
      << "the table of options has changed; write the page's file anew: "
         "build/release/bin/ccst_option_file "
      << kOptionFile;
}

TEST(OptionFile, HasAnglesInDegreesAndLeavesLimitsToTheServer) {
  const std::string text = OptionFileText();
  EXPECT_THAT(text, testing::HasSubstr("\"range\": \"in (0, 180) degrees\""));
  EXPECT_THAT(text, testing::HasSubstr("\"range\": \"at least 4\""));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("thread")));
}

}  // namespace
}  // namespace ccst
