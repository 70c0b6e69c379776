#include "proto/convert/options.h"

#include <algorithm>
#include <memory>
#include <string>

#include "proto/convert/enums.h"
#include "proto/convert/option_fields.h"

namespace ccst {
namespace {

DensitySource SourceOf(const v1::SamplingOptions& options) {
  switch (options.density_case()) {
    case v1::SamplingOptions::kAttribute:
      return DensitySource::kAttribute;
    case v1::SamplingOptions::kCurvature:
      return DensitySource::kCurvature;
    case v1::SamplingOptions::kTexture:
      return DensitySource::kTexture;
    case v1::SamplingOptions::DENSITY_NOT_SET:
      break;
  }
  return DensitySource::kUniform;
}

// The message of a density, in `options`; null for a uniform one.
google::protobuf::Message* MutableDensity(DensitySource source, v1::SamplingOptions& options) {
  switch (source) {
    case DensitySource::kUniform:
      break;
    case DensitySource::kAttribute:
      return options.mutable_attribute();
    case DensitySource::kCurvature:
      return options.mutable_curvature();
    case DensitySource::kTexture:
      return options.mutable_texture();
  }
  return nullptr;
}

void TakeImage(const v1::TextureDensity& texture, const RequestLimits& limits,
               const std::string& path, Violations& violations, DensityOptions& density) {
  const auto size = static_cast<std::int64_t>(texture.image().size());
  if (size == 0) {
    violations.Add(path, "is missing, must be a PNG or JPEG");
  } else if (size > limits.max_texture_bytes) {
    violations.AddLimit(path, "max_texture_bytes", limits.max_texture_bytes, size);
  } else {
    density.encoded_image = std::make_shared<const std::string>(texture.image());
  }
}

void TakeDensity(const v1::SamplingOptions& options, const RequestLimits& limits,
                 const std::string& prefix, Violations& violations, DensityOptions& density) {
  density.source = SourceOf(options);
  const auto& reflection = *options.GetReflection();
  const auto* const oneof = v1::SamplingOptions::descriptor()->FindOneofByName("density");
  const auto* const field = reflection.GetOneofFieldDescriptor(options, oneof);
  if (field == nullptr) return;
  const std::string inner = prefix + field->name() + ".";
  ReadOptionFields(reflection.GetMessage(options, field), limits, inner, violations, density);
  if (options.has_texture()) {
    TakeImage(options.texture(), limits, inner + "image", violations, density);
  }
}

}  // namespace

v1::SamplingOptions ToProto(const SamplingOptions& options) {
  v1::SamplingOptions message;
  WriteOptionFields(options, message);
  const DensityOptions& density = options.density;
  if (auto* const inner = MutableDensity(density.source, message)) {
    WriteOptionFields(density, *inner);
  }
  if (density.source == DensitySource::kTexture && density.encoded_image != nullptr) {
    message.mutable_texture()->set_image(*density.encoded_image);
  }
  return message;
}

SamplingOptions FromProto(const v1::SamplingOptions& options, const RequestLimits& limits,
                          const std::string& path, Violations& violations) {
  const std::string prefix = path.empty() ? "" : path + ".";
  SamplingOptions result;
  result.time_limit_seconds = limits.max_job_seconds;
  result.max_iterations =
      DefaultMaxIterations(FromProto(options.method()).value_or(SamplingMethod::kCcst));
  ReadOptionFields(options, limits, prefix, violations, result);
  result.time_limit_seconds = std::min(limits.max_job_seconds, *result.time_limit_seconds);
  TakeDensity(options, limits, prefix, violations, result.density);
  return result;
}

absl::StatusOr<SamplingOptions> FromProto(const v1::SamplingOptions& options,
                                          const RequestLimits& limits) {
  Violations violations;
  SamplingOptions result = FromProto(options, limits, "", violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return result;
}

}  // namespace ccst
