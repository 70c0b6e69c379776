#include "proto/convert/options.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "proto/convert/enums.h"
#include "proto/convert/scalars.h"

namespace ccst {
namespace {

template <typename Message>
void SetShape(const DensityOptions& density, Message& message) {
  message.set_exponent(density.exponent);
  message.set_max_contrast(density.max_contrast);
}

void SetDensity(const DensityOptions& density, v1::SamplingOptions& message) {
  switch (density.source) {
    case DensitySource::kUniform:
      break;
    case DensitySource::kAttribute:
      message.mutable_attribute()->set_attribute_name(density.attribute);
      SetShape(density, *message.mutable_attribute());
      break;
    case DensitySource::kCurvature:
      message.mutable_curvature()->set_measure(ToProto(density.measure));
      SetShape(density, *message.mutable_curvature());
      break;
    case DensitySource::kTexture:
      if (density.encoded_image != nullptr) {
        message.mutable_texture()->set_image(*density.encoded_image);
      }
      message.mutable_texture()->set_bright_is_dense(density.bright_is_dense);
      SetShape(density, *message.mutable_texture());
      break;
  }
}

template <typename Message>
void TakeShape(const Message& message, const std::string& path, DensityOptions& density,
               Violations& violations) {
  if (message.has_exponent()) density.exponent = message.exponent();
  if (!(density.exponent >= 0.0 && density.exponent <= kMaxDensityExponent)) {
    violations.Add(path + ".exponent", "must be in [0, 4]");
  }
  if (message.has_max_contrast()) density.max_contrast = message.max_contrast();
  if (!(density.max_contrast > 1.0 && density.max_contrast <= kMaxDensityContrast)) {
    violations.Add(path + ".max_contrast", "must be above 1 and at most 1e6");
  }
}

DensityOptions DensityFromProto(const v1::SamplingOptions& options, const RequestLimits& limits,
                                const std::string& prefix, Violations& violations) {
  DensityOptions density;
  if (options.has_attribute()) {
    density.source = DensitySource::kAttribute;
    density.attribute = options.attribute().attribute_name();
    if (density.attribute.empty()) {
      violations.Add(prefix + "attribute.attribute_name", "is missing");
    }
    TakeShape(options.attribute(), prefix + "attribute", density, violations);
  } else if (options.has_curvature()) {
    density.source = DensitySource::kCurvature;
    if (const auto measure = FromProto(options.curvature().measure())) {
      density.measure = *measure;
    } else {
      violations.Add(prefix + "curvature.measure",
                     "is " + std::to_string(options.curvature().measure()) +
                         ", must be MEASURE_GAUSSIAN (1), MEASURE_MEAN (2) or MEASURE_MAXIMUM (3)");
    }
    TakeShape(options.curvature(), prefix + "curvature", density, violations);
  } else if (options.has_texture()) {
    density.source = DensitySource::kTexture;
    density.bright_is_dense = options.texture().bright_is_dense();
    const auto size = static_cast<std::int64_t>(options.texture().image().size());
    if (size == 0) {
      violations.Add(prefix + "texture.image", "is missing, must be a PNG or JPEG");
    } else if (size > limits.max_texture_bytes) {
      violations.AddLimit(prefix + "texture.image", "max_texture_bytes", limits.max_texture_bytes,
                          size);
    } else {
      density.encoded_image = std::make_shared<const std::string>(options.texture().image());
    }
    TakeShape(options.texture(), prefix + "texture", density, violations);
  }
  return density;
}

}  // namespace

v1::SamplingOptions ToProto(const SamplingOptions& options) {
  v1::SamplingOptions message;
  message.set_sample_count(options.sample_count);
  message.set_max_iterations(options.max_iterations);
  message.set_relative_tolerance(options.relative_tolerance);
  message.set_seed(options.seed);
  message.set_method(ToProto(options.method));
  if (options.crease_angle.has_value()) message.set_crease_angle_radians(*options.crease_angle);
  message.set_energy(ToProto(options.energy));
  SetDensity(options.density, message);
  message.set_weld_tolerance(options.weld_tolerance);
  if (options.time_limit_seconds.has_value()) {
    *message.mutable_time_limit() = DurationToProto(*options.time_limit_seconds);
  }
  return message;
}

SamplingOptions FromProto(const v1::SamplingOptions& options, const RequestLimits& limits,
                          const std::string& path, Violations& violations) {
  const std::string prefix = path.empty() ? "" : path + ".";
  SamplingOptions result;
  result.sample_count = options.sample_count();
  if (result.sample_count < kMinSampleCount) {
    violations.Add(prefix + "sample_count", "is " + std::to_string(result.sample_count) +
                                                ", must be at least " +
                                                std::to_string(kMinSampleCount));
  } else if (result.sample_count > limits.max_sample_count) {
    violations.AddLimit(prefix + "sample_count", "max_sample_count", limits.max_sample_count,
                        result.sample_count);
  }
  if (const auto method = FromProto(options.method())) {
    result.method = *method;
  } else {
    violations.Add(prefix + "method", "is " + std::to_string(options.method()) +
                                          ", must be a SamplingMethod, SAMPLING_METHOD_CCST (1) to "
                                          "SAMPLING_METHOD_SAMPLE_ELIMINATION (6)");
  }
  result.max_iterations = std::min(DefaultMaxIterations(result.method), limits.max_iterations);
  if (options.has_max_iterations()) {
    result.max_iterations = options.max_iterations();
    if (result.max_iterations < 0) {
      violations.Add(prefix + "max_iterations",
                     "is " + std::to_string(result.max_iterations) + ", must be at least 0");
    } else if (result.max_iterations > limits.max_iterations) {
      violations.AddLimit(prefix + "max_iterations", "max_iterations", limits.max_iterations,
                          result.max_iterations);
    }
  }
  if (options.has_relative_tolerance()) {
    result.relative_tolerance = options.relative_tolerance();
    if (!std::isfinite(result.relative_tolerance) || result.relative_tolerance <= 0.0) {
      violations.Add(prefix + "relative_tolerance", "must be finite and above 0");
    }
  }
  if (options.has_seed()) result.seed = options.seed();
  result.time_limit_seconds = limits.max_job_seconds;
  if (options.has_time_limit()) {
    if (IsPositiveDuration(options.time_limit())) {
      result.time_limit_seconds =
          std::min(limits.max_job_seconds, SecondsFromProto(options.time_limit()));
    } else {
      violations.Add(prefix + "time_limit", "must be a valid duration above 0");
    }
  }
  if (options.has_crease_angle_radians()) {
    result.crease_angle = options.crease_angle_radians();
    if (!(*result.crease_angle > 0.0 && *result.crease_angle < std::numbers::pi)) {
      violations.Add(prefix + "crease_angle_radians", "must be in (0, pi)");
    }
  }
  result.density = DensityFromProto(options, limits, prefix, violations);
  if (const auto energy = FromProto(options.energy())) {
    result.energy = *energy;
  } else {
    violations.Add(prefix + "energy", "is " + std::to_string(options.energy()) +
                                          ", must be ENERGY_TARGET (1) or ENERGY_SQUARED_AREA (2)");
  }
  result.weld_tolerance = options.weld_tolerance();
  if (!std::isfinite(result.weld_tolerance) || result.weld_tolerance < 0.0) {
    violations.Add(prefix + "weld_tolerance", "must be finite and at least 0");
  }
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
