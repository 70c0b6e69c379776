#include "core/surface/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/surface/closest_point.h"

namespace ccst {
namespace {

/// Dense points tried for one target.
constexpr std::size_t kNearest = 8;
/// Rows of dense points along a face's longest edge, at most.
constexpr int kMaxRows = 64;
/// Faces that share a box, and boxes that share one of the next level.
constexpr std::size_t kRun = 8;
/// Runs whose boxes one thread makes in one go.
constexpr std::int64_t kPiece = 1024;
/// Longer than any error of a distance in the unit frame.
constexpr double kSlack = 1e-14;

double SquaredDistance(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& p) {
  return box.squaredExteriorDistance(p);
}

/// Square of the distance of `p` to the segment from `a` to `b`.
double SquaredDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                       const Eigen::Vector3d& p) {
  const Eigen::Vector3d along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0.0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + t * along - p).squaredNorm();
}

/// A dense point by how near it is, then by where it stands: face, row, place in the row.
using Found = std::tuple<double, std::int32_t, std::int32_t>;

/// The nearest found so far.
class NearestPoints {
 public:
  /// Whether what is `squared` away, up to rounding, may be among the nearest.
  bool MayTake(double squared) const {
    return best_.size() < kNearest ||
           std::sqrt(squared) <= std::sqrt(std::get<0>(best_.back())) + kSlack;
  }

  void Take(const Found& found) {
    if (best_.size() == kNearest) {
      if (!(found < best_.back())) return;
      best_.pop_back();
    }
    best_.insert(std::upper_bound(best_.begin(), best_.end(), found), found);
  }

  std::vector<std::int32_t> Faces() const {
    std::vector<std::int32_t> faces;
    faces.reserve(best_.size());
    for (const Found& found : best_) faces.push_back(std::get<1>(found));
    return faces;
  }

 private:
  std::vector<Found> best_;
};

}  // namespace

/// The centroids of the rows^2 congruent parts of each face that stand like the face itself, and
/// boxes around runs of faces, which follow each other in space.
class Projection::DensePoints {
 public:
  DensePoints(const Surface& surface, double spacing, const Parallel& parallel)
      : surface_(surface), spacing_(spacing) {
    const auto faces = static_cast<std::size_t>(surface.face_count());
    levels_.emplace_back((faces + kRun - 1) / kRun);
    parallel.ForRanges(static_cast<std::int64_t>(levels_.front().size()), kPiece,
                       [&](std::int64_t first, std::int64_t end) {
                         for (auto r = static_cast<std::size_t>(first);
                              r < static_cast<std::size_t>(end); ++r) {
                           levels_.front()[r] = BoxOfFaces(kRun * r, faces);
                         }
                       });
    while (levels_.back().size() > kRun) {
      const Boxes& below = levels_.back();
      Boxes boxes((below.size() + kRun - 1) / kRun);
      for (std::size_t i = 0; i < below.size(); ++i) boxes[i / kRun].extend(below[i]);
      levels_.push_back(std::move(boxes));
    }
  }

  /// The faces of the kNearest points nearest to `target`, nearest first and equal distances by the
  /// order of the points; fewer when there are fewer.
  std::vector<std::int32_t> NearestFaces(const Eigen::Vector3d& target) const {
    NearestPoints nearest;
    struct Entry {
      double squared;
      std::size_t level;
      std::size_t box;
      bool operator<(const Entry& other) const { return squared > other.squared; }
    };
    std::priority_queue<Entry> queue;  // The nearest first.
    const auto add = [&](std::size_t level, std::size_t first, std::size_t end) {
      for (std::size_t b = first; b < std::min(end, levels_[level].size()); ++b) {
        queue.push({SquaredDistance(levels_[level][b], target), level, b});
      }
    };
    add(levels_.size() - 1, 0, kRun);
    while (!queue.empty() && nearest.MayTake(queue.top().squared)) {
      const Entry entry = queue.top();
      queue.pop();
      if (entry.level > 0) {
        add(entry.level - 1, kRun * entry.box, kRun * (entry.box + 1));
        continue;
      }
      const auto end = std::min(kRun * (entry.box + 1), surface_.faces().size());
      for (std::size_t f = kRun * entry.box; f < end; ++f) {
        AddFace(static_cast<std::int32_t>(f), target, &nearest);
      }
    }
    return nearest.Faces();
  }

 private:
  using Boxes = std::vector<Eigen::AlignedBox3d>;

  Eigen::AlignedBox3d BoxOfFaces(std::size_t first, std::size_t face_count) const {
    Eigen::AlignedBox3d box;
    for (std::size_t f = first; f < std::min(first + kRun, face_count); ++f) {
      for (const std::int32_t v : surface_.faces()[f]) box.extend(surface_.positions()[v]);
    }
    return box;
  }

  void AddFace(std::int32_t face, const Eigen::Vector3d& target, NearestPoints* nearest) const {
    const Eigen::Vector3d& a = surface_.positions()[surface_.faces()[face][0]];
    const Eigen::Vector3d& b = surface_.positions()[surface_.faces()[face][1]];
    const Eigen::Vector3d& c = surface_.positions()[surface_.faces()[face][2]];
    const Eigen::Vector3d closest = ClosestWeights(target, a, b, c);
    const Eigen::Vector3d place = closest[0] * a + closest[1] * b + closest[2] * c;
    if (!nearest->MayTake((place - target).squaredNorm())) return;
    const double longest =
        std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const int rows =
        static_cast<int>(std::clamp(longest / spacing_, 1.0, static_cast<double>(kMaxRows)));
    for (int i = 0; i < rows; ++i) {
      const auto point = [&](int j) -> Eigen::Vector3d {
        const double u = (i + 1.0 / 3.0) / rows;
        const double v = (j + 1.0 / 3.0) / rows;
        return (1.0 - u - v) * a + u * b + v * c;
      };
      if (!nearest->MayTake(SquaredDistance(point(0), point(rows - i - 1), target))) continue;
      for (int j = 0; i + j < rows; ++j) {
        const Eigen::Vector3d offset = target - point(j);
        const double squared =
            offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2];
        nearest->Take({squared, face, kMaxRows * i + j});
      }
    }
  }

  const Surface& surface_;
  const double spacing_;
  std::vector<Boxes> levels_;  // Lowest first; the last holds kRun boxes at most.
};

Projection::Projection(const Surface* surface, double spacing, const Parallel* parallel)
    : surface_(*surface), spacing_(spacing), parallel_(*parallel) {}
Projection::~Projection() = default;

SurfacePoint Projection::Project(std::int32_t face, const Eigen::Vector3d& target,
                                 const Eigen::Vector3d& normal, double tolerance) {
  SurfacePoint best = surface_.Follow(face, target);
  double least = (best.position - target).norm();
  if (least <= tolerance) return best;
  if (dense_ == nullptr) dense_ = std::make_unique<DensePoints>(surface_, spacing_, parallel_);
  const SurfacePoint host = surface_.ClosestOnFace(face, best.position);
  for (const std::int32_t f : dense_->NearestFaces(target)) {
    const SurfacePoint point = surface_.Follow(f, target);
    const double distance = (point.position - target).norm();
    if (distance >= least || surface_.NormalAt(point.face, point.weights).dot(normal) <= 0.0) {
      continue;
    }
    const SurfacePoint back = surface_.Follow(point.face, host.position);
    if ((back.position - host.position).norm() > 1e-9) continue;
    best = point;
    least = distance;
  }
  return best;
}

}  // namespace ccst
