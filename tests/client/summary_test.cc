#include "client/cli/summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ccst::cli {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

SampleOutcome Outcome() {
  SampleOutcome outcome;
  outcome.result.samples.positions.resize(12);
  outcome.result.samples.triangles.resize(20);
  outcome.result.termination = Termination::kTimeLimit;
  outcome.result.alternations = 9;
  outcome.result.passes = 11;
  outcome.result.energy = 0.5;
  outcome.result.capacity_cv = 0.25;
  outcome.result.relative_radius = 0.7;
  outcome.result.surface = {.vertices = 8,
                            .faces = 12,
                            .area = 24.0,
                            .diagonal = 3.5,
                            .components = 1,
                            .boundary_loops = 2,
                            .euler = 0,
                            .closed_loops = 3,
                            .untriangulated_components = 6,
                            .untriangulated_samples = 7,
                            .repairs = {.welded_vertices = 4,
                                        .repeated_index_faces = 8,
                                        .duplicate_faces = 9,
                                        .degenerate_faces = 10,
                                        .split_faces = 11,
                                        .cut_edges = 12,
                                        .non_orientable_cuts = 13,
                                        .cut_vertices = 14,
                                        .flipped_faces = 15,
                                        .isolated_vertices = 5}};
  outcome.record.samples_sha256 = "abc";
  outcome.record.decode_seconds = 0.5;
  outcome.record.total_seconds = 1.5;
  outcome.job_name = "jobs/7";
  return outcome;
}

FinishedRun Remote() {
  FinishedRun run;
  run.options.seed = 18446744073709551615U;
  run.server = "here:1";
  run.outcome = Outcome();
  return run;
}

TEST(Summary, HasTheKeysOfTheContract) {
  const auto json = nlohmann::json::parse(SummaryJson(Remote()));
  EXPECT_EQ(json.at("count"), 12);
  EXPECT_EQ(json.at("seed"), 18446744073709551615U);
  EXPECT_EQ(json.at("method"), "ccst");
  EXPECT_EQ(json.at("converged"), false);
  EXPECT_EQ(json.at("termination"), "time_limit");
  EXPECT_EQ(json.at("alternations"), 9);
  EXPECT_EQ(json.at("passes"), 11);
  EXPECT_EQ(json.at("energy"), 0.5);
  EXPECT_EQ(json.at("capacity_cv"), 0.25);
  EXPECT_EQ(json.at("relative_radius"), 0.7);
  EXPECT_EQ(json.at("samples_digest"), "abc");
  const auto& surface = json.at("surface");
  EXPECT_EQ(surface.at("vertices"), 8);
  EXPECT_EQ(surface.at("faces"), 12);
  EXPECT_EQ(surface.at("area"), 24.0);
  EXPECT_EQ(surface.at("components"), 1);
  EXPECT_EQ(surface.at("boundary_loops"), 2);
  EXPECT_EQ(surface.at("euler"), 0);
  EXPECT_EQ(surface.at("untriangulated_components"), 6);
  EXPECT_EQ(surface.at("untriangulated_samples"), 7);
  const nlohmann::json repairs = {
      {"welded_vertices", 4}, {"isolated_vertices", 5}, {"repeated_index_faces", 8},
      {"duplicate_faces", 9}, {"degenerate_faces", 10}, {"split_faces", 11},
      {"cut_edges", 12},      {"cut_vertices", 14},     {"non_orientable_cuts", 13},
      {"flipped_faces", 15},  {"closed_loops", 3}};
  EXPECT_EQ(surface.at("repairs"), repairs);
  for (const char* key : {"decode", "prepare", "initialise", "optimise", "total"}) {
    EXPECT_TRUE(json.at("seconds").at(key).is_number()) << key;
  }
  EXPECT_EQ(json.at("job"), "jobs/7");
  EXPECT_EQ(json.at("server"), "here:1");
}

TEST(Summary, LocalRunsHaveNoJobAndNoServer) {
  FinishedRun run;
  run.outcome = Outcome();
  run.outcome.job_name.clear();
  const auto json = nlohmann::json::parse(SummaryJson(run));
  EXPECT_TRUE(json.at("job").is_null());
  EXPECT_TRUE(json.at("server").is_null());
}

TEST(Summary, TextNamesTheFigures) {
  const std::string text = SummaryText(Remote());
  for (const char* part :
       {"12 samples", "20 triangles", "here:1", "time limit", "25.00 %", "0.700"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(Summary, TextSaysWhatWasRepairedAndWhatIsNotTriangulated) {
  FinishedRun run = Remote();
  EXPECT_THAT(SummaryText(run),
              AllOf(HasSubstr("repaired: 4 vertices welded"), HasSubstr("12 edges of three"),
                    HasSubstr("15 faces turned over\n"), HasSubstr("6 of 1 components"),
                    HasSubstr("7 samples")));
  run.outcome.result.surface.repairs = {};
  run.outcome.result.surface.untriangulated_components = 0;
  EXPECT_THAT(SummaryText(run), Not(AnyOf(HasSubstr("repaired"), HasSubstr("components"))));
}

}  // namespace
}  // namespace ccst::cli
