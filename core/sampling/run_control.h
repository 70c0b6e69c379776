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

/// How a caller watches and stops a run. Never changes the numbers of a whole run.
struct RunControl {
  std::stop_token stop;              ///< Polled at least every 50 ms of work; sticky.
  ProgressSink* progress = nullptr;  ///< Not owned; may be null.
};

}  // namespace ccst
