#pragma once

#include <cstdint>
#include <memory>

#include "core/parallel/parallel.h"
#include "core/surface/surface.h"

namespace ccst {

/// Puts points back on the surface. A small move is followed from the host; when that ends too far
/// away, the place is looked up in a dense discretisation of the surface.
/// Source: Xu et al. 2012, section 3.4 (they always search the discretisation).
class Projection {
 public:
  /// @param surface  not owned. The discretisation, with about `spacing` between its points, is
  /// prepared when it is first needed, by the threads of `parallel` (not owned). Its points are
  /// made anew for every search: of long, thin faces there may be thousands each. Memory O(F).
  Projection(const Surface* surface, double spacing, const Parallel* parallel);
  ~Projection();

  /// The point of the surface for `target`, near the host `face`.
  /// @param normal  unit normal wanted there: a point whose normal is 90 degrees or more away lies
  ///                on another side.
  /// Falls back to the search when following ends more than `tolerance` away; takes what that
  /// finds only if it is closer, on the same side, and following leads back from there to the
  /// host, so that close sheets are not mixed up.
  /// Cost O(faces crossed), and with the search O(log F + dense points of the faces nearby) more.
  SurfacePoint Project(std::int32_t face, const Eigen::Vector3d& target,
                       const Eigen::Vector3d& normal, double tolerance);

 private:
  class DensePoints;

  const Surface& surface_;
  const double spacing_;
  const Parallel& parallel_;
  std::unique_ptr<const DensePoints> dense_;
};

}  // namespace ccst
