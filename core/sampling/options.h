#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "core/density/image.h"
#include "core/sampling/energy.h"

namespace ccst {

/// Smallest and largest `SamplingOptions::sample_count`.
inline constexpr std::int64_t kMinSampleCount = 4;
inline constexpr std::int64_t kMaxSampleCount = 10'000'000;
inline constexpr int kMaxAlternations = 10'000;

/// How samples are made. All but CCST are there to compare with (core/methods): they give no sample
/// mesh and no capacities.
enum class SamplingMethod {
  kCcst,               ///< Capacity-constrained surface triangulation.
  kWhiteNoise,         ///< Independent, proportional to the density.
  kPoissonDisk,        ///< Dart throwing with the radius searched for the count.
  kSampleElimination,  ///< Poisson disk by weighted sample elimination.
  kLloyd,              ///< Lloyd's relaxation.
  kCcvt,               ///< Capacity-constrained Voronoi tessellation; at most 20,000 samples.
};

/// Steps after which a method is given up by default.
int DefaultMaxIterations(SamplingMethod method);

/// Where the target density comes from.
enum class DensitySource {
  kUniform,
  kAttribute,  ///< A scalar attribute of the mesh, linear over each face.
  kCurvature,  ///< The shape.
  kTexture,    ///< An image over the mesh's texture coordinates.
};

/// What is measured of the principal curvatures k1, k2 [1 / mesh unit].
enum class CurvatureMeasure {
  kGaussian,  ///< sqrt(|k1 k2|), the paper's choice (its figure 4).
  kMean,      ///< |k1 + k2| / 2.
  kMaximum,   ///< max(|k1|, |k2|).
};

inline constexpr double kMaxDensityExponent = 4.0;
inline constexpr double kMaxDensityContrast = 1e6;

/// The target density of samples; only its ratios count.
struct DensityOptions {
  DensitySource source = DensitySource::kUniform;
  std::string attribute;  ///< Name of the attribute; its values must be finite and >= 0.
  CurvatureMeasure measure = CurvatureMeasure::kGaussian;
  std::shared_ptr<const Image> image;                ///< Dark places get more samples.
  std::shared_ptr<const std::string> encoded_image;  ///< What `image` is decoded from before the
                                                     ///< run, by whoever has a decoder.
  bool bright_is_dense = false;                      ///< Bright places get more samples instead.
  double exponent = 1.0;        ///< In [0, kMaxDensityExponent]; power of the source.
  double max_contrast = 100.0;  ///< In (1, kMaxDensityContrast]; densities below the
                                ///< largest over this are raised to it.
};

/// Everything that determines the samples, apart from the mesh; `thread_count` must not change
/// them. A new field needs a description in option_table.h.
struct SamplingOptions {
  SamplingMethod method = SamplingMethod::kCcst;
  std::int64_t sample_count = 0;  ///< Required, in [kMinSampleCount, kMaxSampleCount].
  int max_iterations = 130;  ///< Alternations or steps, in [0, kMaxAlternations]; 0: initial set.
  double relative_tolerance = 0.12;  ///< > 0; stop when capacity_cv improves by less
                                     ///< than this an alternation, over three of them.
  std::uint64_t seed = 0;            ///< Part of the result's identity.
  Energy energy = Energy::kTarget;
  DensityOptions density;
  /// Samples and edges of the sample mesh stay on edges at which the faces turn by more than this
  /// [rad], in (0, pi); corners get a sample that stays. For CCST only.
  std::optional<double> crease_angle;
  /// Wall-clock bound of the whole run [s], > 0. A run that hits it returns what it has: its last
  /// whole iterate, or an error where there is none yet. Results then depend on the machine.
  std::optional<double> time_limit_seconds;
  int thread_count = 1;         ///< >= 1.
  double weld_tolerance = 0.0;  ///< Vertices this near are joined first [mesh unit], >= 0 and
                                ///< finite; 0: those at one place. Samples stay on the input.

  /// INVALID_ARGUMENT naming the first wrong field and its range.
  absl::Status Validate() const;
};

}  // namespace ccst
