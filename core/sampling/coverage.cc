#include "core/sampling/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/spatial/point_tree.h"
#include "core/surface/closest_point.h"
#include "core/surface/curvature.h"

namespace ccst {
namespace {

/// Least curvature, times the spacing, at which a place can be cut off by more than half a spacing.
constexpr double kLeastCurvature = 0.7;
/// Samples whose triangles are tried for each place.
constexpr int kNearest = 4;

}  // namespace

Coverage::Coverage(const Surface* surface, const Density* density, const Plan* plan)
    : surface_(*surface) {
  for (std::int32_t v = 0; v < surface->vertex_count(); ++v) {
    const std::int32_t h = surface->outgoing()[v];
    if (surface->twins()[h] < 0) continue;  // Loops have their own samples.
    if (plan->components[surface->face_components()[h / 3]].points) continue;
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();
    weights[h % 3] = 1.0;
    const PrincipalCurvatures curvature =
        Diagonalise(surface->ShapeAt(h / 3, weights), surface->normals()[v]);
    const double spacing =
        plan->LocalSpacing(density->At(h / 3, weights, plan->spacing * plan->spacing));
    if (std::abs(curvature.k1) * spacing <= kLeastCurvature) continue;
    curved_.push_back(v);
    spacing_.push_back(spacing);
  }
}

std::vector<UncoveredPlace> Coverage::FindUncovered(const SampleMesh& mesh, const Samples& samples,
                                                    double limit) const {
  std::vector<UncoveredPlace> found;
  if (curved_.empty()) return found;
  const PointTree tree(samples.position);
  for (std::size_t k = 0; k < curved_.size(); ++k) {
    const std::int32_t v = curved_[k];
    const Eigen::Vector3d& place = surface_.positions()[v];
    UncoveredPlace nearest{v, -1, std::numeric_limits<double>::infinity(), spacing_[k]};
    const std::int32_t component = surface_.face_components()[surface_.outgoing()[v] / 3];
    for (const std::int32_t i : tree.Nearest(place, kNearest)) {
      if (samples.component[i] != component) continue;
      // Triangles on the other side of a thin part do not cover this one.
      if (samples.normal[i].dot(surface_.normals()[v]) < -0.5) continue;
      mesh.ForEachOutgoing(i, [&](std::int32_t h) {
        const Eigen::Vector3d& a = samples.position[i];
        const Eigen::Vector3d& b = samples.position[mesh.Target(h)];
        const Eigen::Vector3d& c = samples.position[mesh.Apex(h)];
        const Eigen::Vector3d w = ClosestWeights(place, a, b, c);
        const double distance = (w[0] * a + w[1] * b + w[2] * c - place).norm() / spacing_[k];
        if (distance < nearest.distance) {
          nearest.distance = distance;
          nearest.triangle = h / 3;
        }
      });
    }
    if (nearest.triangle >= 0 && nearest.distance > limit) found.push_back(nearest);
  }
  std::sort(found.begin(), found.end(), [](const UncoveredPlace& a, const UncoveredPlace& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.vertex < b.vertex;
  });
  std::vector<UncoveredPlace> apart;
  for (const UncoveredPlace& place : found) {
    const bool close = std::any_of(apart.begin(), apart.end(), [&](const UncoveredPlace& other) {
      return (surface_.positions()[place.vertex] - surface_.positions()[other.vertex]).norm() <
             place.spacing;
    });
    if (!close) apart.push_back(place);
  }
  return apart;
}

}  // namespace ccst
