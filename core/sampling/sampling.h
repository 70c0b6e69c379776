#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/run_control.h"

namespace ccst {

/// Changes whenever equal requests may give other samples.
inline constexpr int kAlgorithmRevision = 1;

/// Smallest and largest `SamplingOptions::sample_count`.
inline constexpr std::int64_t kMinSampleCount = 4;
inline constexpr std::int64_t kMaxSampleCount = 10'000'000;
inline constexpr int kMaxAlternations = 10'000;

/// What a geometry phase minimises.
enum class Energy {
  kTarget,       ///< sum_t (C_t - C*)^2, the variance about the fixed target.
  kSquaredArea,  ///< sum_t C_t^2, as printed in the paper; pulls samples off tips.
};

/// Everything that determines the samples, apart from the mesh. `thread_count` must not
/// change them.
struct SamplingOptions {
  std::int64_t sample_count = 0;     ///< Required, in [kMinSampleCount, kMaxSampleCount].
  int max_iterations = 130;          ///< Alternations, in [0, kMaxAlternations]; 0: initial set.
  double relative_tolerance = 0.12;  ///< > 0; stop when capacity_cv improves by less
                                     ///< than this an alternation, over three of them.
  std::uint64_t seed = 0;            ///< Part of the result's identity.
  Energy energy = Energy::kTarget;
  /// Wall-clock bound of the computation [s], > 0; a run that hits it returns its last whole
  /// iterate. Results then depend on the machine.
  std::optional<double> time_limit_seconds;
  int thread_count = 1;  ///< >= 1.

  /// INVALID_ARGUMENT naming the first wrong field and its range.
  absl::Status Validate() const;
};

/// Why a run ended by itself or was ended.
enum class Termination { kConverged, kIterationLimit, kTimeLimit, kStopped };

/// Facts about the surface that was sampled.
struct SurfaceSummary {
  std::int64_t vertices = 0;  ///< After merging bitwise equal positions; isolated ones dropped.
  std::int64_t faces = 0;
  double area = 0.0;      ///< [mesh unit^2]
  double diagonal = 0.0;  ///< Of the bounding box [mesh unit].
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  std::int64_t euler = 0;  ///< V - E + F.
  std::int64_t closed_loops =
      0;  ///< Boundary loops too short for samples, closed in the sample mesh.
  std::int64_t welded_vertices = 0;    ///< Vertices merged into an equal one.
  std::int64_t isolated_vertices = 0;  ///< Vertices of no face, ignored.
};

/// n samples and the triangulation over them. Arrays are parallel.
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
  double relative_radius = 0.0;  ///< d_min / r_max between samples on the same side.
  double prepare_seconds = 0.0;
  double initialise_seconds = 0.0;
  double optimise_seconds = 0.0;
};

/// Distributes options.sample_count blue-noise samples over `mesh` and triangulates them.
///
/// @param mesh     V x 3 positions, F x 3 indices; an oriented 2-manifold, closed or with
///                 boundary, of any genus and any number of components.
/// @param options  see SamplingOptions.
/// @param run      stop and progress; being stopped is a result, not an error.
/// @return exactly sample_count samples in an order fixed by mesh, options and seed. The same
///         bits for every thread_count, with and without a progress sink.
/// @errors INVALID_ARGUMENT       OPTION_INVALID | MESH_EMPTY | MESH_DEGENERATE (names the first
///                                culprit) | COUNT_TOO_SMALL (names the smallest that works)
///         FAILED_PRECONDITION    MESH_NOT_MANIFOLD (says where)
///         CANCELLED              stopped before there was an iterate to return
/// Validation errors come first, then a stop requested before the start.
/// Cost O((n + F) log(n + F)) to start, O(n) an alternation. Thread-safe: a pure function.
/// Source: Xu, Hu, Gotsman, Liu, "Blue noise sampling of surfaces", C&G 36(4), 2012; deviations
///         with reasons in core/docs/algorithm.md.
absl::StatusOr<SamplingResult> SampleSurface(const TriangleMesh& mesh,
                                             const SamplingOptions& options,
                                             const RunControl& run = {});

}  // namespace ccst
