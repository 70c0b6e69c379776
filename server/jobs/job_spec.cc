#include "server/jobs/job_spec.h"

#include <bit>
#include <string_view>

#include "core/base/sha256.h"
#include "core/sampling/algorithm_revision.h"

namespace ccst::server {
namespace {

constexpr std::int64_t kBytesPerVertex = 100;
constexpr std::int64_t kBytesPerFace = 400;
constexpr std::int64_t kBytesPerSample = 800;
constexpr std::int64_t kFixedBytes = std::int64_t{8} << 20;

// name=value lines; a name never holds what a value could forge, lengths come first.
class Fields {
 public:
  void Add(std::string_view name, std::string_view value) {
    hash_.Add(std::string(name) + ':' + std::to_string(value.size()) + '=');
    hash_.Add(value);
    hash_.Add("\n");
  }
  void Add(std::string_view name, std::int64_t value) { Add(name, std::to_string(value)); }
  void Add(std::string_view name, double value) {
    Add(name, static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(value)));
  }
  std::string Digest() { return hash_.Finish(); }

 private:
  Sha256 hash_;
};

}  // namespace

std::string SpecDigest(const JobSpec& spec) {
  const SamplingOptions& options = spec.options;
  const DensityOptions& density = options.density;
  Fields fields;
  fields.Add("revision", std::int64_t{kAlgorithmRevision});
  fields.Add("mesh", spec.mesh_sha256);
  fields.Add("method", static_cast<std::int64_t>(options.method));
  fields.Add("count", options.sample_count);
  fields.Add("iterations", static_cast<std::int64_t>(options.max_iterations));
  fields.Add("tolerance", options.relative_tolerance);
  fields.Add("seed", static_cast<std::int64_t>(options.seed));
  fields.Add("energy", static_cast<std::int64_t>(options.energy));
  fields.Add("crease", options.crease_angle.value_or(0.0));
  fields.Add("weld", options.weld_tolerance);
  fields.Add("density", static_cast<std::int64_t>(density.source));
  fields.Add("attribute", density.attribute);
  fields.Add("measure", static_cast<std::int64_t>(density.measure));
  fields.Add("texture", spec.texture_sha256);
  fields.Add("bright", std::int64_t{density.bright_is_dense});
  fields.Add("exponent", density.exponent);
  fields.Add("contrast", density.max_contrast);
  return fields.Digest();
}

std::int64_t EstimateMemory(std::int64_t vertices, std::int64_t faces,
                            const SamplingOptions& options) {
  return kFixedBytes + kBytesPerVertex * vertices + kBytesPerFace * faces +
         kBytesPerSample * options.sample_count;
}

}  // namespace ccst::server
