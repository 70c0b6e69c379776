#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/start/plan.h"
#include "core/spatial/box_tree.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// A tip or ridge of the surface that the sample mesh cuts off.
struct UncoveredPlace {
  std::int32_t vertex = -1;  ///< Of the surface.
  TriangleIndex triangle;    ///< Of the sample mesh, the one nearest to it.
  double distance = 0.0;     ///< Between the two, in units of the spacing there.
  double spacing = 0.0;      ///< Of samples there.
};

/// Looks for places of the surface far from the sample mesh. Only strongly curved vertices are
/// looked at: elsewhere triangles over samples on the surface cannot be far from it.
class Coverage {
 public:
  /// @param interrupt  once requested, the other vertices are left out.
  Coverage(const Surface* surface, const Density* density, const Plan* plan,
           const Parallel* parallel, Interrupt* interrupt);

  /// Vertices of the surface that the sample mesh cuts off by most of a local spacing, at corners
  /// by half of one, farthest first, no two within a spacing of one another. When `interrupt` is
  /// requested, the list is unfinished. Cost O(n + curved vertices).
  std::vector<UncoveredPlace> FindUncovered(const SampleMesh& mesh, const Samples& samples,
                                            Interrupt* interrupt);

 private:
  void FindCurved(const Density& density, const Plan& plan, Interrupt* interrupt);
  // How far curved vertex `k` is from the triangles near it; infinitely far from none where there
  // is a sample next to it, which nearly all have.
  UncoveredPlace Measure(std::size_t k, const BoxTree& tree, const SampleMesh& mesh,
                         const Samples& samples);

  const Surface& surface_;
  const Parallel& parallel_;
  std::vector<std::int32_t> curved_;  // Vertices of the surface.
  std::vector<double> spacing_;       // Per curved vertex.
  std::vector<double> limit_;         // Per curved vertex, in spacings.
  std::vector<std::int32_t> next_;    // Per curved vertex: a sample that was next to it, or -1.
};

}  // namespace ccst::internal
