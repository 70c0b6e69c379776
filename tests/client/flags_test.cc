#include "client/cli/flags.h"

#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "client/cli/exit_code.h"

namespace ccst::cli {
namespace {

Command Parse(std::vector<const char*> arguments, const char* environment_server = nullptr) {
  arguments.insert(arguments.begin(), "ccst");
  return ParseCommandLine(static_cast<int>(arguments.size()), arguments.data(), environment_server);
}

int ExitOf(const Command& command) {
  const auto* done = std::get_if<Done>(&command);
  return done != nullptr ? done->exit_code : -1;
}

TEST(Flags, SampleTakesDefaults) {
  const auto command = std::get<SampleCommand>(Parse({"sample", "a.obj", "--count", "500"}));
  EXPECT_EQ(command.mesh, "a.obj");
  EXPECT_EQ(command.options.sample_count, 500);
  EXPECT_EQ(command.options.seed, 0U);
  EXPECT_EQ(command.options.energy, Energy::kTarget);
  EXPECT_EQ(command.options.weld_tolerance, 0.0);
  EXPECT_EQ(command.options.max_iterations, SamplingOptions().max_iterations);
  EXPECT_EQ(command.options.relative_tolerance, SamplingOptions().relative_tolerance);
  EXPECT_FALSE(command.options.time_limit_seconds.has_value());
  EXPECT_EQ(command.server, "localhost:50051");
  EXPECT_EQ(command.progress, ProgressStyle::kAuto);
  EXPECT_FALSE(command.quantization_bits.has_value());
}

TEST(Flags, SampleTakesEveryFlag) {
  const auto command = std::get<SampleCommand>(Parse({"sample",
                                                      "a.obj",
                                                      "--count",
                                                      "500",
                                                      "-o",
                                                      "s.ply",
                                                      "--mesh-output",
                                                      "m.glb",
                                                      "--picture",
                                                      "p.png",
                                                      "--summary",
                                                      "s.json",
                                                      "--seed",
                                                      "18446744073709551615",
                                                      "--energy",
                                                      "squared-area",
                                                      "--weld-tolerance",
                                                      "0.01",
                                                      "--max-iterations",
                                                      "7",
                                                      "--tolerance",
                                                      "0.5",
                                                      "--time-limit",
                                                      "1.5",
                                                      "--server",
                                                      "example:1",
                                                      "--progress",
                                                      "json",
                                                      "--quantization-bits",
                                                      "14"}));
  EXPECT_EQ(command.samples_path, "s.ply");
  EXPECT_EQ(command.mesh_path, "m.glb");
  EXPECT_EQ(command.picture_path, "p.png");
  EXPECT_EQ(command.summary_path, "s.json");
  EXPECT_EQ(command.options.seed, 18446744073709551615U);
  EXPECT_EQ(command.options.energy, Energy::kSquaredArea);
  EXPECT_EQ(command.options.weld_tolerance, 0.01);
  EXPECT_EQ(command.options.max_iterations, 7);
  EXPECT_EQ(command.options.relative_tolerance, 0.5);
  EXPECT_EQ(command.options.time_limit_seconds, 1.5);
  EXPECT_EQ(command.server, "example:1");
  EXPECT_EQ(command.progress, ProgressStyle::kJson);
  EXPECT_EQ(command.quantization_bits, 14);
}

TEST(Flags, ServerComesFromFlagThenEnvironment) {
  const std::vector<const char*> sample = {"sample", "a.obj", "--count", "9"};
  EXPECT_EQ(std::get<SampleCommand>(Parse(sample, "there:2")).server, "there:2");
  EXPECT_EQ(std::get<SampleCommand>(Parse(sample, "")).server, "localhost:50051");
  EXPECT_EQ(std::get<InfoCommand>(Parse({"info"}, "there:2")).server, "there:2");
  EXPECT_EQ(std::get<InfoCommand>(Parse({"info", "--server", "here:1"}, "there:2")).server,
            "here:1");
}

TEST(Flags, LocalIgnoresTheServerOfTheEnvironment) {
  const auto command = std::get<SampleCommand>(
      Parse({"sample", "a.obj", "--count", "9", "--local", "--threads", "3"}, "there:2"));
  EXPECT_EQ(command.server, "");
  EXPECT_EQ(command.options.thread_count, 3);
}

TEST(Flags, InfoTakesJson) {
  EXPECT_FALSE(std::get<InfoCommand>(Parse({"info"})).json);
  EXPECT_TRUE(std::get<InfoCommand>(Parse({"info", "--json"})).json);
}

TEST(Flags, HelpAndVersionAreNoErrors) {
  EXPECT_EQ(ExitOf(Parse({"--help"})), kOk);
  EXPECT_EQ(ExitOf(Parse({"sample", "--help"})), kOk);
  EXPECT_EQ(ExitOf(Parse({"--version"})), kOk);
}

TEST(Flags, WrongCommandLinesAreUsageErrors) {
  const std::vector<std::vector<const char*>> wrong = {
      {},
      {"nonsense"},
      {"sample"},
      {"sample", "a.obj"},
      {"sample", "--count", "9"},
      {"sample", "a.obj", "--count", "many"},
      {"sample", "a.obj", "--count", "9", "b.obj"},
      {"sample", "a.obj", "--count", "9", "--unknown"},
      {"sample", "a.obj", "--count", "9", "--energy", "0"},
      {"sample", "a.obj", "--count", "9", "--progress", "loud"},
      {"sample", "a.obj", "--count", "9", "--seed", "-1"},
      {"sample", "a.obj", "--count", "9", "--threads", "2"},
      {"sample", "a.obj", "--count", "9", "--local", "--threads", "0"},
      {"sample", "a.obj", "--count", "9", "--local", "--server", "here:1"},
      {"sample", "a.obj", "--count", "9", "--quantization-bits", "25"},
      {"sample", "a.obj", "--count", "9", "--method", "white", "--mesh-output", "m.drc"},
      {"sample", "a.obj", "--count", "9", "--mesh-output", "m.glb", "--method", "poisson"},
      {"sample", "a.obj", "--count", "9", "-o", "s.doc"},
      {"sample", "a.obj", "--count", "9", "--picture", "p.jpg"},
      {"sample", "a.obj", "--count", "9", "--mesh-output", "m.3ds"},
      {"sample", "a.obj", "--count", "9", "-o", "-", "--mesh-output", "-"},
      {"sample", "a.obj", "--count", "9", "-o", "same.ply", "--mesh-output", "./same.ply"},
      {"sample", "a.obj", "--count", "9", "-o", "/no/such/folder/s.ply"},
      {"info", "--count", "9"},
  };
  for (const auto& arguments : wrong) {
    EXPECT_EQ(ExitOf(Parse(arguments)), kUsage)
        << (arguments.empty() ? "nothing" : arguments.back());
  }
}

}  // namespace
}  // namespace ccst::cli
