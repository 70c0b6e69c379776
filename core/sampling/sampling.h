#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/mesh/triangle_mesh.h"
#include "core/repair/repair.h"
#include "core/sampling/run_control.h"

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

/// What a geometry phase minimises.
enum class Energy {
  kTarget,       ///< sum_t (C_t - C*)^2, the variance about the fixed target.
  kSquaredArea,  ///< sum_t C_t^2, as printed in the paper; pulls samples off tips.
};

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

/// Everything that determines the samples, apart from the mesh. `thread_count` must not
/// change them.
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
  /// Wall-clock bound of the computation [s], > 0; a run that hits it returns its last whole
  /// iterate. Results then depend on the machine.
  std::optional<double> time_limit_seconds;
  int thread_count = 1;         ///< >= 1.
  double weld_tolerance = 0.0;  ///< Vertices this near are joined first [mesh unit], >= 0 and
                                ///< finite; 0: those at one place. Samples stay on the input.

  /// INVALID_ARGUMENT naming the first wrong field and its range.
  absl::Status Validate() const;
};

/// Why a run ended by itself or was ended.
enum class Termination { kConverged, kIterationLimit, kTimeLimit, kStopped };

/// Facts about the surface that was sampled.
struct SurfaceSummary {
  std::int64_t vertices = 0;  ///< After repair, as all of the following.
  std::int64_t faces = 0;
  double area = 0.0;      ///< [mesh unit^2]
  double diagonal = 0.0;  ///< Of the bounding box [mesh unit].
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  std::int64_t creases = 0;  ///< Lines between corners that samples were kept on.
  std::int64_t euler = 0;    ///< V - E + F.
  std::int64_t closed_loops =
      0;  ///< Boundary loops too short for samples, closed in the sample mesh.
  /// Components too small for a triangulation at this sample_count, and how many samples lie on
  /// them: placed by capacity, in no sample triangle.
  std::int64_t untriangulated_components = 0;
  std::int64_t untriangulated_samples = 0;
  RepairReport repairs;  ///< What it took to make a surface of the input.
};

/// n samples and the triangulation over them. Arrays are parallel. Every prefix is well spread.
struct SampleSet {
  std::vector<std::int32_t> faces;            ///< n: host face, an index into the input's faces.
  std::vector<Eigen::Vector2d> barycentrics;  ///< n: weights of the host's corners 0 and 1, >= 0,
                                              ///< sum <= 1. Exact: positions derive from these.
  std::vector<Eigen::Vector3d> positions;     ///< n x 3 on the surface [mesh unit].
  std::vector<Eigen::Vector3d> normals;       ///< n x 3 unit, interpolated over the host.
  std::vector<Eigen::Vector3i> triangles;     ///< m x 3 indices of samples; the sample mesh.
  std::vector<Attribute> attributes = {};     ///< n x K each; see InterpolateAttributes().
};

/// What SampleSurface() returns.
struct SamplingResult {
  SampleSet samples;
  SurfaceSummary surface;
  Termination termination = Termination::kConverged;
  int alternations = 0;
  std::int64_t passes = 0;  ///< Sweeps over all samples, summed over the alternations.
  double energy = 0.0;      ///< As in AlternationReport.
  double capacity_cv = 0.0;
  double relative_radius = 0.0;  ///< d_min / r_max between samples on the same side, distances
                                 ///< in units of the spacing that the density asks for there.
  double prepare_seconds = 0.0;
  double initialise_seconds = 0.0;
  double optimise_seconds = 0.0;
};

/// Distributes options.sample_count blue-noise samples over `mesh` and triangulates them.
///
/// @param mesh     V x 3 positions, F x 3 indices; of any kind. What is not an oriented 2-manifold
///                 is made one first (core/repair/repair.h) and the answer says how.
/// @param options  see SamplingOptions.
/// @param run      stop and progress; being stopped is a result, not an error.
/// @return exactly sample_count samples in an order fixed by mesh, options and seed in which every
///         prefix is well spread (but for white noise, and unless it was stopped). The same
///         bits for every thread_count, with and without a progress sink.
/// @errors INVALID_ARGUMENT       OPTION_INVALID | DENSITY_INVALID | MESH_EMPTY | MESH_DEGENERATE
/// (names the first
///                                culprit) | COUNT_TOO_SMALL (names the smallest that works)
///         CANCELLED              stopped before there was an iterate to return
/// Validation errors come first, then a stop requested before the start.
/// Cost O((n + F) log(n + F)) to start, O(n) an alternation. Thread-safe: a pure function.
/// Source: Xu, Hu, Gotsman, Liu, "Blue noise sampling of surfaces", C&G 36(4), 2012; deviations
///         with reasons in core/docs/algorithm.md.
absl::StatusOr<SamplingResult> SampleSurface(const TriangleMesh& mesh,
                                             const SamplingOptions& options,
                                             const RunControl& run = {});

}  // namespace ccst
