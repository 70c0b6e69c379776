#include "client/cli/progress.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ccst::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

AlternationReport Report(int alternation, int limit) {
  AlternationReport report;
  report.alternation = alternation;
  report.alternation_limit = limit;
  report.energy = 0.00125;
  report.capacity_cv = 0.0312;
  report.flips = 17;
  report.relocations = 2;
  report.elapsed_seconds = 1.25;
  return report;
}

// What was written to `file`.
std::string Contents(std::FILE* file) {
  std::string text(static_cast<std::size_t>(std::ftell(file)), '\0');
  std::rewind(file);
  text.resize(std::fread(text.data(), 1, text.size(), file));
  return text;
}

// What a printer writes to a file, which is no terminal.
std::string Printed(ProgressStyle style, int alternations) {
  std::unique_ptr<std::FILE, decltype(&std::fclose)> file(std::tmpfile(), &std::fclose);
  ProgressPrinter printer(style, file.get());
  printer.Note("waiting");
  for (int i = 0; i < alternations; ++i) printer.Show(Report(i, alternations));
  printer.Finish();
  return Contents(file.get());
}

TEST(ProgressLine, ShowsTheFigures) {
  const std::string line = ProgressLine(Report(12, 60));
  for (const char* part : {"12", "1.250e-03", "3.12 %", "flips 17", "relocations 2", "1.2 s"}) {
    EXPECT_THAT(line, HasSubstr(part));
  }
}

TEST(ProgressBar, FillsWithTheAlternations) {
  const auto full = [](int alternation) {
    const std::string bar = ProgressBar(Report(alternation, 60), 80);
    return std::count(bar.begin(), bar.end(), '#');
  };
  EXPECT_EQ(full(0), 0);
  EXPECT_LT(full(10), full(30));
  EXPECT_EQ(std::string(ProgressBar(Report(60, 60), 80)).find('.'),
            ProgressBar(Report(60, 60), 80).find("1.250e-03") + 1);
}

TEST(ProgressBar, FitsTheTerminal) {
  for (const int width : {70, 80, 120, 300}) {
    EXPECT_LT(ProgressBar(Report(199, 200), width).size(), static_cast<std::size_t>(width));
  }
}

TEST(ProgressBar, TakesALimitOfZero) {
  EXPECT_THAT(ProgressBar(Report(0, 0), 80), StartsWith("[###"));
}

TEST(ProgressJson, HasTheKeysOfTheContract) {
  const auto json = nlohmann::json::parse(ProgressJson(Report(12, 60)));
  EXPECT_EQ(json.size(), 6U);
  EXPECT_EQ(json.at("iteration"), 12);
  EXPECT_EQ(json.at("energy"), 0.00125);
  EXPECT_EQ(json.at("capacity_cv"), 0.0312);
  EXPECT_EQ(json.at("flips"), 17);
  EXPECT_EQ(json.at("relocations"), 2);
  EXPECT_EQ(json.at("elapsed"), 1.25);
}

TEST(ProgressPrinter, AutoWritesLinesWhereNoTerminalIs) {
  EXPECT_EQ(Printed(ProgressStyle::kAuto, 3), Printed(ProgressStyle::kLines, 3));
  const std::string text = Printed(ProgressStyle::kLines, 3);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
}

TEST(ProgressPrinter, JsonWritesNothingElse) {
  const std::string text = Printed(ProgressStyle::kJson, 3);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_EQ(std::count(text.begin(), text.end(), '{'), 3);
}

TEST(ProgressPrinter, BarStaysOnOneLine) {
  const std::string text = Printed(ProgressStyle::kBar, 3);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
}

TEST(ProgressPrinter, NotesHoldNothingThatATerminalObeys) {
  for (const ProgressStyle style : {ProgressStyle::kLines, ProgressStyle::kBar}) {
    const std::unique_ptr<std::FILE, decltype(&std::fclose)> file(std::tmpfile(), &std::fclose);
    ProgressPrinter(style, file.get()).Note("lost: \x1b]0;title\x07\nand more");
    EXPECT_THAT(Contents(file.get()), HasSubstr("lost: \\u001b]0;title\\u0007\\nand more"));
  }
}

TEST(ProgressPrinter, NoneIsSilent) { EXPECT_EQ(Printed(ProgressStyle::kNone, 3), ""); }

}  // namespace
}  // namespace ccst::cli
