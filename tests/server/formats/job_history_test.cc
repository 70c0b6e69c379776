#include "server/formats/job_history.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

TEST(JobHistories, KeepEveryReport) {
  std::vector<AlternationReport> reports(1000);
  for (int i = 0; i < 1000; ++i) {
    AlternationReport& report = reports[static_cast<std::size_t>(i)];
    report.alternation = i;
    report.alternation_limit = 1000;
    report.energy = 1.0 / (i + 1);
    report.capacity_cv = 2.0 / (i + 1);
    report.flips = std::int64_t{5} << 32;
    report.relocations = 3;
    report.max_displacement = 0.1;
    report.elapsed_seconds = 1e-7 * i;
  }
  const auto read = *DecodeHistory(EncodeHistory(reports));
  ASSERT_EQ(read.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(read[i].alternation, reports[i].alternation);
    EXPECT_EQ(read[i].alternation_limit, 1000);
    EXPECT_EQ(read[i].energy, reports[i].energy);
    EXPECT_EQ(read[i].capacity_cv, reports[i].capacity_cv);
    EXPECT_EQ(read[i].flips, std::int64_t{5} << 32);
    EXPECT_EQ(read[i].relocations, 3);
    EXPECT_EQ(read[i].max_displacement, 0.1);
    EXPECT_EQ(read[i].elapsed_seconds, reports[i].elapsed_seconds);
  }
}

TEST(JobHistories, NoReportsAreNoBytes) {
  EXPECT_EQ(EncodeHistory({}), "");
  EXPECT_TRUE(DecodeHistory("")->empty());
}

TEST(JobHistories, DamageIsNoticed) {
  for (const char* bytes : {"\x7f", "\x1a", "a history"}) {
    EXPECT_EQ(GetErrorReason(DecodeHistory(bytes).status()), ErrorReason::kStorageFailed);
  }
}

}  // namespace
}  // namespace ccst::server
