#include "client/cli/flag_kinds.h"

namespace ccst::cli {
namespace {

const std::vector<std::pair<std::string, ProgressStyle>> kProgressStyles = {
    {"auto", ProgressStyle::kAuto},
    {"bar", ProgressStyle::kBar},
    {"lines", ProgressStyle::kLines},
    {"json", ProgressStyle::kJson},
    {"none", ProgressStyle::kNone}};

const std::vector<std::pair<std::string, CurvatureMeasure>> kCurvatures = {
    {"gaussian", CurvatureMeasure::kGaussian},
    {"mean", CurvatureMeasure::kMean},
    {"maximum", CurvatureMeasure::kMaximum}};
// uniform, curvature, attribute:NAME or texture:IMAGE. Throws CLI::ValidationError.
void ParseDensity(const std::string& text, DensityOptions& density, std::string& texture_path) {
  const std::size_t colon = text.find(':');
  const std::string source = text.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : text.substr(colon + 1);
  texture_path.clear();
  if (text == "uniform") {
    density.source = DensitySource::kUniform;
  } else if (text == "curvature") {
    density.source = DensitySource::kCurvature;
  } else if (source == "attribute" && !rest.empty()) {
    density.source = DensitySource::kAttribute;
    density.attribute = rest;
  } else if (source == "texture" && !rest.empty()) {
    density.source = DensitySource::kTexture;
    texture_path = rest;
  } else {
    throw CLI::ValidationError("--density", "'" + text +
                                                "' is none of uniform, curvature, attribute:NAME, "
                                                "texture:IMAGE");
  }
}

}  // namespace

void AddDensity(CLI::App& app, DensityOptions& density, std::string& texture_path) {
  app.add_option_function<std::string>(
         "--density",
         [&density, &texture_path](const std::string& text) {
           ParseDensity(text, density, texture_path);
         },
         "Where more samples belong: uniform, curvature, attribute:NAME of the mesh, or "
         "texture:IMAGE (.png .jpg), dark places dense")
      ->type_name("SOURCE")
      ->default_str("uniform");
  AddChoice(app, "--curvature", kCurvatures, density.measure,
            "What a curvature density follows: gaussian, mean or maximum");
  app.add_option("--density-exponent", density.exponent,
                 "Power of the source that the density is, 0 to 4")
      ->type_name("E")
      ->capture_default_str();
  app.add_option("--density-contrast", density.max_contrast,
                 "Largest density over smallest; smaller ones are raised")
      ->type_name("C")
      ->capture_default_str();
  app.add_flag("--bright-is-dense", density.bright_is_dense,
               "Bright places of the image get more samples, not dark ones");
}

void AddProgress(CLI::App& app, ProgressStyle& progress) {
  AddChoice(app, "--progress", kProgressStyles, progress,
            "auto, bar, lines, json or none, on standard error");
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
