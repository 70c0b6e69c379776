#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/parallel/parallel.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// A state of the samples and their mesh to go back to: what a relaxation changes of them, without
/// what follows from it. About 90 bytes a sample.
class Snapshot {
 public:
  /// In the place of what was taken before: a second one would not fit beside it. Cost O(n).
  void Take(const SampleMesh& mesh, const Samples& samples);

  /// Puts `mesh` and `samples` back. The snapshot is empty then. Cost O(n).
  /// @param surface  of the samples. @pre Take() was called since the last Restore().
  void Restore(const Surface& surface, const Parallel& parallel, SampleMesh* mesh,
               Samples* samples);

 private:
  std::vector<std::int32_t> origin_;
  std::vector<std::int32_t> twin_;
  std::vector<std::uint8_t> locked_;
  std::vector<std::int32_t> outgoing_;
  std::vector<std::int32_t> face_;
  std::vector<Eigen::Vector3d> weights_;
  std::vector<double> arc_;
};

}  // namespace ccst::internal
