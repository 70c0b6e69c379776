#include "server/jobs/job_spec.h"

#include <bit>
#include <concepts>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/base/sha256.h"
#include "core/sampling/algorithm_revision.h"
#include "core/sampling/option_table.h"

namespace ccst::server {
namespace {

// name=value lines; a name never holds what a value could forge, lengths come first.
class Fields {
 public:
  void Add(std::string_view name, const std::string& value) { Add(name, std::string_view(value)); }
  void Add(std::string_view name, std::string_view value) {
    hash_.Add(std::string(name) + ':' + std::to_string(value.size()) + '=');
    hash_.Add(value);
    hash_.Add("\n");
  }
  template <typename Whole>
  requires std::integral<Whole>
  void Add(std::string_view name, Whole value) {
    Add(name, std::string_view(std::to_string(value)));
  }
  void Add(std::string_view name, double value) { Add(name, std::bit_cast<std::uint64_t>(value)); }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void Add(std::string_view name, Enum value) { Add(name, static_cast<int>(value)); }
  template <typename Field>
  void Add(std::string_view name, const std::optional<Field>& value) {
    if (value.has_value()) Add(name, *value);
  }
  std::string Digest() { return hash_.Finish(); }

 private:
  Sha256 hash_;
};

// Adds every option that changes samples.
class OptionAdder {
 public:
  explicit OptionAdder(Fields& fields) : fields_(fields) {}

  template <typename Kind, typename Field>
  void operator()(const Kind& option, const Field& value) {
    if (option.info.changes_samples) fields_.Add(option.info.name, value);
  }
  // The digest of an image's bytes stands in the JobSpec, whose options have no image.
  template <typename Pointer>
  void operator()(const ImageOption& /*option*/, const Pointer& /*image*/) {}

 private:
  Fields& fields_;
};

}  // namespace

std::string SpecDigest(const JobSpec& spec) {
  // Taken apart, so that a new field stops this from compiling: say here whether it counts.
  const auto& [owner, share, request_id, display_name, labels, mesh_sha256, texture_sha256, options,
               origin, abandon_seconds, ends_with_caller, skip_cache_lookup] = spec;
  Fields fields;
  fields.Add("revision", kAlgorithmRevision);
  fields.Add("mesh", mesh_sha256);
  fields.Add("texture", texture_sha256);
  VisitOptions(options, OptionAdder(fields));
  return fields.Digest();
}

}  // namespace ccst::server
