#include "client/cli/flag_kinds.h"

#include <array>

#include "client/cli/option_flags.h"

namespace ccst::cli {
namespace {

constexpr auto kProgressStyles = std::to_array<Choice<ProgressStyle>>({
    {ProgressStyle::kAuto, "auto", ""},
    {ProgressStyle::kBar, "bar", ""},
    {ProgressStyle::kLines, "lines", ""},
    {ProgressStyle::kJson, "json", ""},
    {ProgressStyle::kNone, "none", ""},
});
constexpr ChoiceOption<ProgressStyle> kProgressOption = {
    .info = {.name = "progress",
             .field = "",
             .word = "progress",
             .label = "",
             .help = "How progress is shown on standard error"},
    .choices = kProgressStyles,
};

}  // namespace

void AddProgress(CLI::App& app, ProgressStyle& progress) {
  AddChoice(app, kProgressOption, progress);
}

void AddQuantization(CLI::App& app, std::optional<int>& bits) {
  app.add_option("--quantization-bits", bits,
                 "Send coordinates with N bits, 1 to 24: smaller uploads, moved vertices")
      ->type_name("N")
      ->check(CLI::Range(1, 24).description(""));
}

void AddLabels(CLI::App& app, std::map<std::string, std::string>& labels, const std::string& help) {
  const auto assign = [&labels](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos || equals == 0) {
        throw CLI::ValidationError("--label", "'" + text + "' is not of the form KEY=VALUE");
      }
      labels[text.substr(0, equals)] = text.substr(equals + 1);
    }
  };
  app.add_option_function<std::vector<std::string>>("--label", assign, help)
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
}

void AddServer(CLI::App& app, ServerAddress& server) {
  app.add_option("--server", server.server,
                 "Server that computes; else $CCST_SERVER, else localhost:50051")
      ->type_name("HOST:PORT");
  AddServerFlags(app, server.server_flags);
}

}  // namespace ccst::cli
