#include "tests/options/option_file.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "core/sampling/option_table.h"

namespace ccst {
namespace {

// In the order of the table.
using Json = nlohmann::ordered_json;

// a_name or a-name as aName.
std::string CamelCase(std::string_view name) {
  std::string text;
  bool starts_word = false;
  for (const char c : name) {
    if (c == '_' || c == '-') {
      starts_word = true;
      continue;
    }
    text += starts_word ? static_cast<char>(c - 'a' + 'A') : c;
    starts_word = false;
  }
  return text;
}

// The page shows the density's options under that title.
std::string PageName(std::string_view word) {
  constexpr std::string_view kPrefix = "density-";
  if (word.starts_with(kPrefix)) word.remove_prefix(kPrefix.size());
  return CamelCase(word);
}

class Describer {
 public:
  template <typename Number>
  void operator()(const NumberOption& option, const Number& value) {
    AddNumber<Number>(option, static_cast<double>(value));
  }
  template <typename Number>
  void operator()(const NumberOption& option, const std::optional<Number>& value) {
    AddNumber<Number>(option, value);
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, const Enum& /*value*/) {
    Json* const entry = Add(option.info, "choice");
    if (entry == nullptr) return;
    for (const Choice<Enum>& choice : option.choices) {
      (*entry)["choices"].push_back({std::string(choice.name), std::string(choice.words)});
    }
  }
  void operator()(const SwitchOption& option, const bool& /*value*/) { Add(option.info, "switch"); }
  void operator()(const TextOption& option, const std::string& /*value*/) {
    Add(option.info, "text");
  }
  template <typename Pointer>
  void operator()(const ImageOption& option, const Pointer& /*value*/) {
    Add(option.info, "image");
  }

  const Json& json() const { return json_; }

 private:
  // Null for an option that the API does not take.
  Json* Add(const OptionInfo& info, const char* kind) {
    if (info.field.empty()) return nullptr;
    Json& entry = json_[PageName(info.word)];
    entry["kind"] = kind;
    entry["field"] = CamelCase(info.field);
    entry["label"] = std::string(info.label);
    entry["help"] = std::string(info.help);
    entry["group"] = std::string(GroupName(info.group));
    entry["use"] = std::string(UseName(info.use));
    entry["inDensity"] = info.name.starts_with("density.") && info.field != "density";
    entry["changesSamples"] = info.changes_samples;
    return &entry;
  }

  template <typename Number>
  void AddNumber(const NumberOption& option, std::optional<double> value) {
    Json* const entry = Add(option.info, "number");
    if (entry == nullptr) return;
    // What a server advertises is for it to judge.
    Range range = option.range;
    if (!option.limit.empty()) range.most = Range().most;
    const UnitScale scale = ScaleOf(option.unit);
    (*entry)["whole"] = std::is_integral_v<Number>;
    if (std::isfinite(range.least)) (*entry)["least"] = scale.ToUser(range.least);
    if (std::isfinite(range.most)) (*entry)["most"] = scale.ToUser(range.most);
    (*entry)["hasLeast"] = range.has_least;
    (*entry)["hasMost"] = range.has_most;
    (*entry)["range"] = RangeWords(range, option.unit, Wording::kUser);
    (*entry)["times"] = scale.times;
    (*entry)["over"] = scale.over;
    (*entry)["default"] = DefaultWords(option, value);
  }

  Json json_;
};

}  // namespace

std::string OptionFileText() {
  Describer describer;
  const SamplingOptions defaults;
  VisitOptions(defaults, describer);
  return describer.json().dump(2) + "\n";
}

}  // namespace ccst
