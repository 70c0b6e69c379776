#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/parallel/parallel.h"
#include "core/spatial/point_tree.h"
#include "core/surface/surface.h"

namespace ccst {

/// Puts points back on the surface. A small move is followed from the host; when that ends too far
/// away, the place is looked up in a dense discretisation of the surface.
/// Source: Xu et al. 2012, section 3.4 (they always search the discretisation).
class Projection {
 public:
  /// @param surface  not owned. The discretisation, with about `spacing` between its points, is
  /// built when it is first needed, by the threads of `parallel` (not owned).
  Projection(const Surface* surface, double spacing, const Parallel* parallel)
      : surface_(*surface), spacing_(spacing), parallel_(*parallel) {}

  /// The point of the surface for `target`, near the host `face`.
  /// @param normal  unit normal wanted there: a point whose normal is 90 degrees or more away lies
  ///                on another side.
  /// Falls back to the search when following ends more than `tolerance` away; takes what that
  /// finds only if it is closer, on the same side, and following leads back from there to the
  /// host, so that close sheets are not mixed up.
  /// Cost O(faces crossed), O(log(dense points)) more with the search.
  SurfacePoint Project(std::int32_t face, const Eigen::Vector3d& target,
                       const Eigen::Vector3d& normal, double tolerance);

 private:
  void Discretise();

  const Surface& surface_;
  const double spacing_;
  const Parallel& parallel_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::int32_t> faces_;  // Per point.
  std::unique_ptr<PointTree> tree_;
};

}  // namespace ccst
