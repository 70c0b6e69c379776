#include "core/sampling/relax/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "core/mesh/faces.h"
#include "core/spatial/box_tree.h"
#include "core/spatial/point_tree.h"
#include "core/surface/closest_point.h"
#include "core/surface/curvature.h"
#include "core/surface/frame.h"

namespace ccst::internal {
namespace {

/// Least curvature, times the spacing, at which a place can be cut off by more than half a spacing.
constexpr double kLeastCurvature = 0.7;
/// Samples whose triangles are tried for each place.
constexpr std::size_t kNearest = 4;
/// Distance of the surface from the sample mesh that calls for a sample there, in spacings.
constexpr double kLimit = 0.9;
/// The same at the corners of polyhedra: vertices whose angles are short of 2 pi by more than
/// kCornerDeficit [rad], with none within kAlone spacings that differs from 2 pi by kFlatDeficit.
/// Tips of a scan, which are noise as often as not, are none.
constexpr double kCornerLimit = 0.55;
constexpr double kCornerDeficit = 1.2;
constexpr double kFlatDeficit = 0.1;
constexpr double kAlone = 3.0;

/// Units of work, for an Interrupt, of looking at what covers a place.
constexpr std::int64_t kPlaceWork = 32;

/// Vertices that one thread looks at in one go.
constexpr std::int32_t kPiece = 4096;

/// 2 pi less the angles of the faces at `vertex`, which is not on the boundary.
double AngleDeficit(const Surface& surface, std::int32_t vertex) {
  double deficit = 2.0 * std::numbers::pi;
  const std::int32_t start = surface.outgoing()[vertex];
  std::int32_t h = start;
  do {
    const std::int32_t previous = PreviousHalfEdge(h);
    deficit -=
        AngleBetween(surface.positions()[surface.Target(h)] - surface.positions()[vertex],
                     surface.positions()[surface.Origin(previous)] - surface.positions()[vertex]);
    h = surface.twins()[previous];
  } while (h != start);
  return deficit;
}

/// The kNearest samples nearest to `place`, nearest first and equal distances by index; fewer when
/// there are fewer.
/// @param radius  > 0: tried first.
std::vector<std::int32_t> NearestSamples(const BoxTree& tree, const Eigen::Vector3d& place,
                                         double radius) {
  std::vector<std::pair<double, std::int32_t>> found;
  // Both are in a cube of side 1.
  for (bool all = false; !all && found.size() < kNearest; radius *= 2.0) {
    all = !(radius > 0.0 && radius <= 2.0);
    found.clear();
    tree.ForEachWithin(place, radius,
                       [&](std::int32_t i, double squared) { found.emplace_back(squared, i); });
  }
  const auto count = static_cast<std::ptrdiff_t>(std::min(found.size(), kNearest));
  std::partial_sort(found.begin(), found.begin() + count, found.end());
  std::vector<std::int32_t> nearest;
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    nearest.push_back(found[static_cast<std::size_t>(k)].second);
  }
  return nearest;
}

/// Places in the cells of a grid, and whether one is near another.
class PlaceGrid {
 public:
  /// @param places  those to come: no distance asked for is longer than their largest spacing.
  explicit PlaceGrid(const std::vector<UncoveredPlace>& places) {
    for (const UncoveredPlace& place : places) side_ = std::max(side_, place.spacing);
    side_ *= 1.0 + 1e-9;  // Rounding must not put what is near two cells away.
  }

  void Insert(const Eigen::Vector3d& position) { cells_[CellOf(position)].push_back(position); }

  /// Whether one is less than `distance` from `position`.
  bool HasNear(const Eigen::Vector3d& position, double distance) const {
    const std::array<std::int64_t, 3> middle = CellOf(position);
    for (int k = 0; k < 27; ++k) {
      const auto cell =
          cells_.find({middle[0] + k % 3 - 1, middle[1] + k / 3 % 3 - 1, middle[2] + k / 9 - 1});
      if (cell == cells_.end()) continue;
      for (const Eigen::Vector3d& other : cell->second) {
        if ((position - other).norm() < distance) return true;
      }
    }
    return false;
  }

 private:
  std::array<std::int64_t, 3> CellOf(const Eigen::Vector3d& position) const {
    std::array<std::int64_t, 3> cell;
    for (int k = 0; k < 3; ++k) {
      cell[k] = static_cast<std::int64_t>(std::floor(position[k] / side_));
    }
    return cell;
  }

  double side_ = 1e-15;
  std::map<std::array<std::int64_t, 3>, std::vector<Eigen::Vector3d>> cells_;
};

}  // namespace

Coverage::Coverage(const Surface* surface, const Density* density, const Plan* plan,
                   const Parallel* parallel, Interrupt* interrupt)
    : surface_(*surface), parallel_(*parallel) {
  FindCurved(*density, *plan, interrupt);
  std::vector<std::size_t> corners;     // Of curved_.
  std::vector<Eigen::Vector3d> places;  // Where the surface is not a bent plane.
  for (std::size_t k = 0; k < curved_.size(); ++k) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(k))) return;
    const double deficit = AngleDeficit(*surface, curved_[k]);
    if (std::abs(deficit) < kFlatDeficit) continue;
    places.push_back(surface->positions()[curved_[k]]);
    if (deficit > kCornerDeficit) corners.push_back(k);
  }
  if (corners.empty()) return;
  const PointTree tree(places, *parallel);
  for (const std::size_t k : corners) {
    const Eigen::Vector3d& corner = surface->positions()[curved_[k]];
    const std::vector<std::int32_t> nearest = tree.Nearest(corner, 2);
    const double alone = kAlone * spacing_[k];
    if (nearest.size() < 2 || (places[nearest[1]] - corner).norm() > alone) {
      limit_[k] = kCornerLimit;
    }
  }
}

void Coverage::FindCurved(const Density& density, const Plan& plan, Interrupt* interrupt) {
  std::vector<std::vector<std::pair<std::int32_t, double>>> pieces(
      (surface_.vertex_count() + kPiece - 1) / kPiece);
  parallel_.For(static_cast<std::int64_t>(pieces.size()), [&, stop = *interrupt](std::int64_t p) {
    Interrupt own = stop;
    const auto first = static_cast<std::int32_t>(p) * kPiece;
    for (std::int32_t v = first; v < std::min(first + kPiece, surface_.vertex_count()); ++v) {
      if (own.RequestedAt(v)) return;
      const std::int32_t h = surface_.outgoing()[v];
      if (surface_.twins()[h] < 0) continue;  // Loops have their own samples.
      if (plan.components[surface_.face_components()[h / 3]].points) continue;
      const Eigen::Vector3d weights = Eigen::Vector3d::Unit(h % 3);
      const PrincipalCurvatures curvature =
          Diagonalise(surface_.ShapeAt(h / 3, weights), surface_.normals()[v]);
      const double spacing =
          plan.LocalSpacing(density.At(h / 3, weights, plan.spacing * plan.spacing));
      if (std::abs(curvature.k1) * spacing <= kLeastCurvature) continue;
      pieces[static_cast<std::size_t>(p)].emplace_back(v, spacing);
    }
  });
  for (const auto& piece : pieces) {
    for (const auto& [v, spacing] : piece) {
      curved_.push_back(v);
      spacing_.push_back(spacing);
    }
  }
  limit_.assign(curved_.size(), kLimit);
  next_.assign(curved_.size(), -1);
}

UncoveredPlace Coverage::Measure(std::size_t k, const BoxTree& tree, const SampleMesh& mesh,
                                 const Samples& samples) {
  const std::int32_t v = curved_[k];
  const Eigen::Vector3d& place = surface_.positions()[v];
  UncoveredPlace nearest{v, TriangleIndex(), std::numeric_limits<double>::infinity(), spacing_[k]};
  const std::int32_t component = surface_.face_components()[surface_.outgoing()[v] / 3];
  const auto may_cover = [&](std::int32_t i) {
    // Triangles on the other side of a thin part do not cover this one.
    return samples.component[i] == component &&
           samples.normal[i].dot(surface_.normals()[v]) >= -0.5;
  };
  const double limit = limit_[k] * spacing_[k];
  const auto is_next = [&](std::int32_t i) {
    return may_cover(i) && mesh.outgoing[i] >= 0 &&
           (samples.position[i] - place).squaredNorm() < limit * limit;
  };
  // Mostly the one of the last time still is.
  if (next_[k] >= 0 && is_next(next_[k])) return nearest;
  next_[k] = -1;
  tree.ForEachWithin(place, limit, [&](std::int32_t i, double) {
    if (next_[k] < 0 && is_next(i)) next_[k] = i;
  });
  if (next_[k] >= 0) return nearest;
  for (const std::int32_t i : NearestSamples(tree, place, spacing_[k])) {
    if (!may_cover(i)) continue;
    mesh.ForEachOutgoing(i, [&](std::int32_t h) {
      const Eigen::Vector3d& a = samples.position[i];
      const Eigen::Vector3d& b = samples.position[mesh.Target(h)];
      const Eigen::Vector3d& c = samples.position[mesh.Apex(h)];
      const Eigen::Vector3d w = ClosestWeights(place, a, b, c);
      const double distance = (w[0] * a + w[1] * b + w[2] * c - place).norm() / spacing_[k];
      if (distance < nearest.distance) {
        nearest.distance = distance;
        nearest.triangle = SampleMesh::TriangleOf(h);
      }
    });
  }
  return nearest;
}

std::vector<UncoveredPlace> Coverage::FindUncovered(const SampleMesh& mesh, const Samples& samples,
                                                    Interrupt* interrupt) {
  std::vector<UncoveredPlace> found;
  if (curved_.empty()) return found;
  BoxTree tree;
  tree.Build(samples.position);
  std::vector<std::vector<UncoveredPlace>> pieces((curved_.size() + kPiece - 1) / kPiece);
  parallel_.For(static_cast<std::int64_t>(pieces.size()), [&, stop = *interrupt](std::int64_t p) {
    Interrupt own = stop;
    const std::size_t first = static_cast<std::size_t>(p) * kPiece;
    for (std::size_t k = first; k < std::min(first + kPiece, curved_.size()); ++k) {
      if (own.RequestedAfter(kPlaceWork)) return;
      const UncoveredPlace place = Measure(k, tree, mesh, samples);
      if (place.triangle >= 0 && place.distance > limit_[k]) {
        pieces[static_cast<std::size_t>(p)].push_back(place);
      }
    }
  });
  for (const std::vector<UncoveredPlace>& piece : pieces) {
    found.insert(found.end(), piece.begin(), piece.end());
  }
  std::sort(found.begin(), found.end(), [](const UncoveredPlace& a, const UncoveredPlace& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.vertex < b.vertex;
  });
  std::vector<UncoveredPlace> apart;
  PlaceGrid taken(found);
  for (const UncoveredPlace& place : found) {
    if (interrupt->RequestedAfter(kPlaceWork)) break;
    const Eigen::Vector3d& position = surface_.positions()[place.vertex];
    if (taken.HasNear(position, place.spacing)) continue;
    taken.Insert(position);
    apart.push_back(place);
  }
  return apart;
}

}  // namespace ccst::internal
