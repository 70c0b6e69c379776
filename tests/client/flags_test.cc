#include "client/cli/flags.h"

#include <fstream>
#include <numbers>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/errors.h"
#include "client/cli/exit_code.h"
#include "client/cli/option_flags.h"
#include "core/sampling/option_table.h"

namespace ccst::cli {
namespace {

using testing::HasSubstr;

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

TEST(Flags, StagesOfALocalRunGoIntoAFolder) {
  const std::string folder = testing::TempDir();
  const auto command = std::get<SampleCommand>(
      Parse({"sample", "a.obj", "--count", "9", "--local", "--dump-stages", folder.c_str()}));
  EXPECT_EQ(command.stages_folder, folder);
}

TEST(Flags, StagesOfARemoteRunAreRefused) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(ExitOf(Parse({"sample", "a.obj", "--count", "9", "--dump-stages", "/tmp"})), kUsage);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("--dump-stages needs --local"));
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

std::string HelpOf(const char* command) {
  testing::internal::CaptureStdout();
  Parse({command, "--help"});
  return testing::internal::GetCapturedStdout();
}

// A value other than the default, in the user's units.
double AnotherValue(const NumberOption& option) {
  return ScaleOf(option.unit).ToUser(option.range.least) + 3.0;
}

TEST(Flags, SampleHasAFlagForEachOption) {
  const SamplingOptions defaults;
  VisitOptions(defaults, [](const auto& option, const auto& /*value*/) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(option)>, NumberOption>) {
      if (!option.info.has_flag) return;
      const std::string flag = "--" + std::string(option.info.word);
      const std::string given = std::to_string(static_cast<int>(AnotherValue(option)));
      std::vector<const char*> arguments = {"sample", "a.obj", flag.c_str(), given.c_str()};
      if (flag != "--count") arguments.insert(arguments.end(), {"-n", "9"});
      const auto command = std::get<SampleCommand>(Parse(arguments));
      VisitOptions(command.options, [&option](const auto& other, const auto& value) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(other)>, NumberOption>) {
          if (other.info.name != option.info.name) return;
          EXPECT_EQ(value, ScaleOf(option.unit).FromUser(AnotherValue(option))) << other.info.name;
        }
      });
    }
  });
}

TEST(Flags, HelpSaysRangesAndDefaults) {
  const std::string help = HelpOf("sample");
  const SamplingOptions defaults;
  VisitOptions(defaults, [&help](const auto& option, const auto& /*value*/) {
    if (!option.info.has_flag) return;
    EXPECT_THAT(help, HasSubstr("--" + std::string(option.info.word) + " "));
    EXPECT_THAT(help, HasSubstr(std::string(option.info.help)));
  });
  EXPECT_THAT(help, HasSubstr("than this; in (0, 180) degrees; by default off"));
  EXPECT_THAT(help, HasSubstr("in [0, 10000]; by default 130, lloyd 100, ccvt 1000"));
  EXPECT_THAT(help, HasSubstr("; finite and greater than 0; by default 0.12"));
  EXPECT_THAT(help, HasSubstr("one of ccst, white, poisson, elimination, lloyd, ccvt; by default"));
  EXPECT_THAT(HelpOf("analyze"), HasSubstr("in [0, 4]; by default 1"));
}

std::string RefusalOf(std::vector<const char*> flags) {
  flags.insert(flags.begin(), {"sample", "a.obj"});
  const auto command = std::get<SampleCommand>(Parse(flags));
  const absl::Status status = CheckOptions(command.options);
  EXPECT_EQ(ExitCodeFor(status), kRefused) << flags.back();
  return std::string(status.message());
}

TEST(Flags, RefusalsNameTheFlagInTheUsersUnits) {
  EXPECT_EQ(RefusalOf({"-n", "3"}), "--count is 3; it must be in [4, 10000000]");
  EXPECT_EQ(RefusalOf({"-n", "9", "--crease-angle", "200"}),
            "--crease-angle is 200; it must be in (0, 180) degrees");
  EXPECT_EQ(RefusalOf({"-n", "9", "--tolerance", "0"}),
            "--tolerance is 0; it must be finite and greater than 0");
  EXPECT_EQ(RefusalOf({"-n", "9", "--density-exponent", "4.5"}),
            "--density-exponent is 4.5; it must be in [0, 4]");
  EXPECT_EQ(RefusalOf({"-n", "9", "--time-limit", "nan"}),
            "--time-limit is nan; it must be greater than 0 seconds");
}

TEST(Flags, AngleIsGivenInDegrees) {
  const auto command =
      std::get<SampleCommand>(Parse({"sample", "a.obj", "--count", "9", "--crease-angle", "40"}));
  EXPECT_EQ(command.options.crease_angle, 40.0 * std::numbers::pi / 180.0);
}

TEST(Flags, MethodsHaveTheirOwnDefaultIterations) {
  const auto lloyd =
      std::get<SampleCommand>(Parse({"sample", "a.obj", "--count", "9", "--method", "lloyd"}));
  EXPECT_EQ(lloyd.options.max_iterations, DefaultMaxIterations(SamplingMethod::kLloyd));
  const auto given = std::get<SampleCommand>(
      Parse({"sample", "a.obj", "--count", "9", "--max-iterations", "7", "--method", "lloyd"}));
  EXPECT_EQ(given.options.max_iterations, 7);
}

TEST(Flags, WrongCommandLinesAreUsageErrors) {
  // A file that exists wherever the test runs: outputs that are inputs are found by what they are.
  const std::string path = testing::TempDir() + "ccst_flags_test_input";
  std::ofstream(path) << "kept";
  const char* const file = path.c_str();
  const std::string texture = "texture:" + path;
  const std::string other = "c=" + path;
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
      {"sample", "a.obj", "--count", "9", "--density", "uniform:"},
      {"sample", "a.obj", "--count", "9", "--density", "curvature:mean"},
      {"sample", "a.obj", "--count", "9", "--density", "attribute"},
      {"sample", "a.obj", "--count", "9", "--density", "texture:"},
      {"sample", "a.obj", "--count", "9", "--threads", "2"},
      {"sample", "a.obj", "--count", "9", "--dump-stages", "/tmp"},
      {"sample", "a.obj", "--count", "9", "--local", "--dump-stages", "/no/such/folder"},
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
      {"sample", "a.obj", "--count", "9", "-o", "/dev/stdout", "--summary", "/dev/stdout"},
      {"sample", file, "--count", "9", "--summary", file},
      {"sample", "a.obj", "--density", texture.c_str(), "--count", "9", "--summary", file},
      {"sample", "a.obj", "--count", "9", "--token-file", file, "--summary", file},
      {"fetch", "7", "--surface", file, "--summary", file},
      {"fetch", "7", "--tls-key", file, "--summary", file},
      {"analyze", file, "--json", file},
      {"analyze", "a.ply", "b.ply", "--surface", file, "--html", file},
      {"analyze", "a.ply", "--json", "new.html", "--html", "./new.html"},
      {"analyze", "a.ply", "--json", "-", "--html", "-"},
      {"compare",
       "a=b.ply,./"
       "b.ply",
       other.c_str(), "--html", file},
      {"info", "--count", "9"},
  };
  for (const auto& arguments : wrong) {
    EXPECT_EQ(ExitOf(Parse(arguments)), kUsage)
        << (arguments.empty() ? "nothing" : arguments.back());
  }
}

}  // namespace
}  // namespace ccst::cli
