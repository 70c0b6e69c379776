#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/quality/triangle_tree.h"
#include "core/surface/surface.h"

namespace ccst::analysis {

/// The surface on which samples are judged, and the density that they should follow.
class ReferenceSurface {
 public:
  /// @param density  of `surface`. @param interrupt  may be null; once requested, looking up places
  /// is right but slow. Cost O(F log F).
  ReferenceSurface(Surface surface, Density density, Interrupt* interrupt = nullptr);

  const Surface& surface() const { return surface_; }
  const Density& density() const { return density_; }
  /// The surface as a plain mesh in its own frame, and a tree over its faces.
  const TriangleMesh& mesh() const { return mesh_; }
  const quality::TriangleTree& tree() const { return tree_; }

  /// Positions of mesh units in the surface's frame.
  std::vector<Eigen::Vector3d> ToFrame(std::span<const Eigen::Vector3d> positions) const;

  /// The points of the surface nearest to `positions`, which are in its frame.
  /// @param interrupt  may be null; once requested, the points mean nothing.
  /// Cost O(n log F).
  std::vector<SurfacePoint> Locate(std::span<const Eigen::Vector3d> positions,
                                   const Parallel& parallel = Parallel(),
                                   Interrupt* interrupt = nullptr) const;

 private:
  Surface surface_;
  Density density_;
  TriangleMesh mesh_;
  quality::TriangleTree tree_;
};

}  // namespace ccst::analysis
