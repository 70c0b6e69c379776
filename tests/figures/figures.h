#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/quality/mesh_topology.h"
#include "core/quality/triangle_tree.h"
#include "core/sampling/sampling.h"

namespace ccst::figures {

/// Whether vertices of equal position are one; where a mesh was cut they are not.
enum class Welding { kEqualPositions, kNone };

/// A surface prepared to be judged against. Built without any code of the sampler.
class ReferenceSurface {
 public:
  /// @param input  as given to the sampler: indices in range, coordinates finite and of a size
  ///               whose square does not overflow, some area.
  explicit ReferenceSurface(const TriangleMesh& input, Welding welding = Welding::kEqualPositions);

  /// The faces of the input in their order; with welding, vertices of equal position merged and
  /// those of no face dropped.
  const TriangleMesh& mesh() const { return mesh_; }
  const quality::TriangleTree& tree() const { return tree_; }
  const quality::MeshTopology& topology() const { return topology_; }
  double area() const { return area_; }                ///< [mesh unit^2]
  double diagonal() const { return diagonal_; }        ///< Of the bounding box [mesh unit].
  double sharp_share() const { return sharp_share_; }  ///< See below.
  bool IsOpen() const { return !topology_.boundary_loops.empty(); }
  /// Over 2 % of the edges turn by more than 40 degrees.
  bool IsCreased() const { return sharp_share_ > 0.02; }
  /// Number of boundary loops shorter than `length` [mesh unit].
  std::int64_t CountLoopsShorterThan(double length) const;

 private:
  TriangleMesh mesh_;
  quality::TriangleTree tree_;
  quality::MeshTopology topology_;
  double area_ = 0.0;
  double diagonal_ = 0.0;
  double sharp_share_ = 0.0;
};

/// Everything measured on one result. Distances are over r_max or over the diagonal.
struct Figures {
  std::int64_t samples = 0;
  double max_distance = 0.0;    ///< Of samples to the surface, over the diagonal.
  double max_host_error = 0.0;  ///< Of samples to the point of their host, over the diagonal;
                                ///< infinite where a host is not one.
  double capacity_cv = 0.0;
  double radius = 0.0;            ///< Of all pairs.
  double radius_same_side = 0.0;  ///< Pairs of hosts less than 90 degrees apart.
  double mean_nearest = 0.0;
  double min_angle = 0.0;    ///< [degree]
  double mean_angle = 0.0;   ///< Mean smallest [degree].
  double below_30 = 0.0;     ///< Share in [0, 1].
  double above_90 = 0.0;     ///< Share in [0, 1].
  double valence_5_7 = 0.0;  ///< Share in [0, 1].
  double hausdorff = 0.0;    ///< Over the diagonal.
  double rms = 0.0;          ///< Over the diagonal.
  std::int64_t turned_over = 0;
  std::int64_t euler = 0;
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  std::string defect;        ///< Why the sample mesh is not manifold; empty when it is.
  std::string closest_pair;  ///< Where radius_same_side is, for a report.
};

/// Measures `result`, which may be wrong in any way.
/// @param input    the mesh the sampler was given.
/// @param surface  built from it.
/// @param spacing  of the points for the Hausdorff distance, as in MeasureSurfaceDistance().
/// Cost about 1 s for 2e4 samples on 2e4 faces, nearly all of it the Hausdorff distance.
Figures MeasureFigures(const TriangleMesh& input, const ReferenceSurface& surface,
                       const SampleSet& samples, double spacing = 0.0);

}  // namespace ccst::figures
