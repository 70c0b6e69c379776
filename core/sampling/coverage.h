#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/plan.h"
#include "core/sampling/sample_mesh.h"
#include "core/sampling/samples.h"
#include "core/surface/surface.h"

namespace ccst {

/// A tip or ridge of the surface that the sample mesh cuts off.
struct UncoveredPlace {
  std::int32_t vertex = -1;    ///< Of the surface.
  std::int32_t triangle = -1;  ///< Of the sample mesh, the one nearest to it.
  double distance = 0.0;       ///< Between the two, in units of the spacing.
};

/// Looks for places of the surface far from the sample mesh. Only strongly curved vertices are
/// looked at: elsewhere triangles over samples on the surface cannot be far from it.
class Coverage {
 public:
  Coverage(const Surface* surface, const Plan* plan);

  /// Vertices of the surface more than `limit` spacings from the sample mesh, farthest first, no
  /// two within a spacing of one another. Cost O(n log n + curved vertices).
  std::vector<UncoveredPlace> FindUncovered(const SampleMesh& mesh, const Samples& samples,
                                            double limit) const;

 private:
  const Surface& surface_;
  const Plan& plan_;
  std::vector<std::int32_t> curved_;
};

}  // namespace ccst
