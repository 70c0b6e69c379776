#include "core/sampling/options.h"

#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/sampling/option_table.h"

namespace ccst {
namespace {

absl::Status OptionError(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

// Remembers the first option that is out of its range.
class RangeChecker {
 public:
  template <typename Number>
  void operator()(const NumberOption& option, const Number& value) {
    if (option.range.Contains(static_cast<double>(value))) return;
    Refuse(option.info, absl::StrCat(value), RangeWords(option.range, option.unit, Wording::kApi));
  }
  template <typename Number>
  void operator()(const NumberOption& option, const std::optional<Number>& value) {
    if (value.has_value()) (*this)(option, *value);
  }
  template <typename Enum>
  void operator()(const ChoiceOption<Enum>& option, const Enum& value) {
    if (option.Find(value) != nullptr) return;
    Refuse(option.info, absl::StrCat(static_cast<int>(value)), "one of " + option.Names());
  }
  // What is right of the others hangs on other options.
  void operator()(const SwitchOption&, const bool&) {}
  void operator()(const TextOption&, const std::string&) {}
  template <typename Pointer>
  void operator()(const ImageOption&, const Pointer&) {}

  const absl::Status& status() const { return status_; }

 private:
  void Refuse(const OptionInfo& info, const std::string& value, const std::string& right) {
    if (!status_.ok()) return;
    status_ =
        OptionError(absl::StrCat(std::string(info.name), " is ", value, "; it must be ", right));
  }

  absl::Status status_;
};

// OPTION_INVALID where the source of the density lacks what it needs; an image that is yet to be
// decoded will do.
absl::Status CheckSource(const DensityOptions& options) {
  if (options.source == DensitySource::kAttribute && options.attribute.empty()) {
    return OptionError("density.attribute is empty; name a scalar attribute of the mesh");
  }
  if (options.source == DensitySource::kTexture && options.image == nullptr &&
      options.encoded_image == nullptr) {
    return OptionError("density.image is missing; a texture density needs an image");
  }
  return absl::OkStatus();
}

}  // namespace

int DefaultMaxIterations(SamplingMethod method) {
  switch (method) {
    case SamplingMethod::kLloyd:
      return 100;
    case SamplingMethod::kCcvt:
      return 1000;
    default:
      return SamplingOptions().max_iterations;
  }
}

absl::Status SamplingOptions::Validate() const {
  RangeChecker checker;
  VisitOptions(*this, checker);
  CCST_RETURN_IF_ERROR(checker.status());
  return CheckSource(density);
}

}  // namespace ccst
