#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include <Eigen/Core>

namespace ccst {

/// What a run is doing.
enum class Phase {
  kPreparing,     ///< Checking the mesh, normals, curvature, search structures.
  kInitializing,  ///< Random samples and their first triangulation.
  kRelaxing,      ///< Alternations.
  kFinalizing,    ///< Quality figures.
};

/// One finished alternation: three passes over the samples, each followed by edge flips, then
/// relocations where they are due.
struct AlternationReport {
  int alternation = 0;            ///< 1-based; 0 is the initial set.
  int alternation_limit = 0;      ///< Upper bound, not a promise.
  double energy = 0.0;            ///< sum_t (C_t - C*)^2 / C*^2 per triangle [1].
  double capacity_cv = 0.0;       ///< std / mean of the sample triangles' capacities [1].
  std::int64_t flips = 0;         ///< Edges flipped.
  std::int64_t relocations = 0;   ///< Samples removed and put elsewhere.
  double max_displacement = 0.0;  ///< Largest move of a sample [mesh unit].
  double elapsed_seconds = 0.0;   ///< Since SampleSurface() was entered.
  /// n x 3, the samples as they are now [mesh unit]; valid during the call only.
  std::span<const Eigen::Vector3d> positions;
};

/// Called on the thread that called SampleSurface(), never concurrently. Alternations are
/// strictly increasing. Must neither throw nor block: queueing belongs to the receiver.
class ProgressSink {
 public:
  virtual ~ProgressSink() = default;
  virtual void OnPhase(Phase phase) = 0;
  virtual void OnAlternation(const AlternationReport& report) = 0;
};

/// The meshes through which a run passes, in this order; those that it does not come to are left
/// out. Methods without a sample mesh have the first and the last alone.
enum class Stage {
  kRepaired,   ///< The input as a surface, its faces in the order in which the run takes them.
  kRefined,    ///< The same after large faces at sharp edges were split, where any were.
  kInitial,    ///< The first samples and their triangulation.
  kEarly,      ///< After the relocations of the first alternations.
  kMended,     ///< After defects were mended once while the rest settled.
  kConverged,  ///< When the capacities had converged first, before what was left was mended.
  kRelaxed,    ///< The best state, with which the relaxation ended.
  kResult,     ///< The samples as they are returned, in their order.
};

/// Shown the mesh of each stage, for people who look for where a run goes wrong. Called like a
/// ProgressSink. Must not throw; the run waits, and what that takes counts against its time limit.
class StageSink {
 public:
  virtual ~StageSink() = default;
  /// @param positions  n x 3 [mesh unit]; like `triangles` valid during the call only.
  /// @param triangles  m x 3 indices of positions; of samples that belong to no triangle none.
  virtual void OnStage(Stage stage, std::span<const Eigen::Vector3d> positions,
                       std::span<const Eigen::Vector3i> triangles) = 0;
};

/// How a caller watches and stops a run. Never changes the numbers of a whole run.
struct RunControl {
  std::stop_token stop = {};         ///< Polled at least every 50 ms of work; sticky.
  ProgressSink* progress = nullptr;  ///< Not owned; may be null.
  StageSink* stages = nullptr;       ///< Not owned; may be null, and then costs nothing.
};

}  // namespace ccst
