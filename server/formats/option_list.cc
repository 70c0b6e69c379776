#include "server/formats/option_list.h"

#include <concepts>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/sampling/option_table.h"
#include "server/formats/stored_message.h"

namespace ccst::server::internal {
namespace {

// Adds one entry for each option it visits.
class OptionWriter {
 public:
  explicit OptionWriter(OptionList& list) : list_(list) {}

  template <typename Number>
  void operator()(const NumberOption& option, const Number& value) {
    if constexpr (std::floating_point<Number>) {
      Add(option.info).set_real(value);
    } else if constexpr (std::unsigned_integral<Number>) {
      Add(option.info).set_natural(value);
    } else {
      Add(option.info).set_whole(value);
    }
  }
  template <typename Number>
  void operator()(const NumberOption& option, const std::optional<Number>& value) {
    if (value.has_value()) (*this)(option, *value);
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, const Enum& value) {
    const auto* const choice = option.Find(value);
    if (choice != nullptr) Add(option.info).set_text(std::string(choice->name));
  }
  void operator()(const SwitchOption& option, const bool& value) {
    Add(option.info).set_flag(value);
  }
  void operator()(const TextOption& option, const std::string& value) {
    Add(option.info).set_text(value);
  }
  // An image is a blob of its own.
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, const Pointer& /*image*/) {}

 private:
  store::v1::Option& Add(const OptionInfo& info) {
    store::v1::Option& entry = *list_.Add();
    entry.set_name(std::string(info.name));
    return entry;
  }

  OptionList& list_;
};

// Sets each option it visits from its entry.
class OptionReader {
 public:
  explicit OptionReader(const OptionList& list) {
    for (const store::v1::Option& entry : list) entries_[entry.name()] = &entry;
  }

  const absl::Status& status() const { return status_; }

  template <typename Number>
  void operator()(const NumberOption& option, Number& value) {
    const store::v1::Option* const entry = Find(option.info);
    if (entry == nullptr) {
      // An option without a default has to be there.
      if (!option.range.Contains(static_cast<double>(value))) Refuse(option.info);
      return;
    }
    if (const auto number = NumberIn<Number>(*entry);
        number.has_value() && option.range.Contains(static_cast<double>(*number))) {
      value = *number;
    } else {
      Refuse(option.info);
    }
  }
  template <typename Number>
  void operator()(const NumberOption& option, std::optional<Number>& value) {
    if (Find(option.info) == nullptr) return;
    (*this)(option, value.emplace());
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, Enum& value) {
    const store::v1::Option* const entry = Find(option.info);
    if (entry == nullptr) return;
    if (const auto* const choice = option.Find(std::string_view(entry->text()))) {
      value = choice->value;
    } else {
      Refuse(option.info);
    }
  }
  void operator()(const SwitchOption& option, bool& value) {
    const store::v1::Option* const entry = Find(option.info);
    if (entry == nullptr) return;
    value = entry->flag();
    if (!entry->has_flag()) Refuse(option.info);
  }
  void operator()(const TextOption& option, std::string& value) {
    const store::v1::Option* const entry = Find(option.info);
    if (entry == nullptr) return;
    value = entry->text();
    if (!entry->has_text()) Refuse(option.info);
  }
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, Pointer& /*image*/) {}

 private:
  const store::v1::Option* Find(const OptionInfo& info) const {
    const auto found = entries_.find(info.name);
    return found == entries_.end() ? nullptr : found->second;
  }

  template <typename Number>
  static std::optional<Number> NumberIn(const store::v1::Option& entry) {
    if constexpr (std::floating_point<Number>) {
      if (entry.has_real()) return entry.real();
    } else if constexpr (std::unsigned_integral<Number>) {
      if (entry.has_natural()) return entry.natural();
    } else {
      constexpr std::int64_t kMost = std::numeric_limits<Number>::max();
      constexpr std::int64_t kLeast = std::numeric_limits<Number>::min();
      const std::int64_t whole = entry.whole();
      if (entry.has_whole() && whole >= kLeast && whole <= kMost) {
        return static_cast<Number>(whole);
      }
    }
    return std::nullopt;
  }

  void Refuse(const OptionInfo& info) {
    status_ = DamagedRecord("option " + std::string(info.name) + " of a job is");
  }

  std::map<std::string_view, const store::v1::Option*> entries_;
  absl::Status status_;
};

}  // namespace

void WriteOptions(const SamplingOptions& options, OptionList& list) {
  VisitOptions(options, OptionWriter(list));
}

absl::Status ReadOptions(const OptionList& list, SamplingOptions& options) {
  OptionReader reader(list);
  VisitOptions(options, reader);
  return reader.status();
}

}  // namespace ccst::server::internal
