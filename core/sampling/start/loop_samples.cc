#include "core/sampling/start/loop_samples.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "core/surface/frame.h"

namespace ccst::internal {
namespace {

constexpr double kCornerTurn = 60.0 * std::numbers::pi / 180.0;
/// Farthest that a crease may lie from the chords between its samples, over the diagonal, as long
/// as they need not be closer than kClosest times their usual distance for it.
constexpr double kLargestSag = 7e-4;
constexpr double kClosest = 0.7;

/// `length` over `side`, rounded; no more than kCountCap, also where the quotient overflows or is
/// none.
std::int64_t RoundedCount(double length, double side) {
  const double count = length / side;
  return count < static_cast<double>(kCountCap) ? std::llround(count) : kCountCap;
}

/// Arc lengths in their order on a loop, and whether one is near another.
class ArcSet {
 public:
  ArcSet(double length, const std::vector<double>& arcs)
      : length_(length), arcs_(arcs.begin(), arcs.end()) {}

  void Insert(double arc) { arcs_.insert(arc); }

  /// Whether one lies nearer to `arc` than `reach`, either way around. The nearest are those next
  /// to it in the order and, around the start of the loop, the first and the last.
  bool HasNear(double arc, double reach) const {
    if (arcs_.empty()) return false;
    const auto is_near = [&](double other) {
      const double gap = std::abs(arc - other);
      return std::min(gap, length_ - gap) < reach;
    };
    const auto after = arcs_.lower_bound(arc);
    return (after != arcs_.end() && is_near(*after)) ||
           (after != arcs_.begin() && is_near(*std::prev(after))) || is_near(*arcs_.begin()) ||
           is_near(*arcs_.rbegin());
  }

 private:
  double length_;
  std::set<double> arcs_;
};

/// Calls piece(begin, end, count) for every stretch of the loop between two corners, with the
/// number of samples from `begin` on.
template <typename Piece>
void ForEachPiece(const LoopPlan& loop, const std::vector<double>& corners, double side,
                  const Piece& piece) {
  const auto pieces = static_cast<std::int64_t>(corners.size());
  const std::int64_t least = pieces == 1 ? 3 : pieces == 2 ? 2 : 1;
  for (std::int64_t c = 0; c < pieces; ++c) {
    const double begin = corners[c];
    const double end = c + 1 < pieces ? corners[c + 1] : corners[0] + loop.length;
    piece(begin, end, std::max(least, RoundedCount(end - begin, side)));
  }
}

/// Largest distance of the crease from `pieces` chords between evenly spread samples; of those
/// looked at when `interrupt` was requested.
double SagOf(const Surface& surface, const LoopPlan& crease, std::int64_t pieces,
             Interrupt* interrupt) {
  double largest = 0.0;
  std::size_t next = 0;  // The vertices of the line, by arc.
  for (std::int64_t i = 0; i < pieces && !interrupt->RequestedAt(i); ++i) {
    const auto arc_of = [&](std::int64_t k) {
      return crease.length * static_cast<double>(k) / static_cast<double>(pieces);
    };
    const Eigen::Vector3d from = PointAt(surface, crease, arc_of(i)).position;
    const Eigen::Vector3d along = PointAt(surface, crease, arc_of(i + 1)).position - from;
    for (; next < crease.start.size() && crease.start[next] < arc_of(i + 1); ++next) {
      const Eigen::Vector3d at =
          surface.positions()[surface.Origin(crease.half_edges[next])] - from;
      const double t = std::clamp(at.dot(along) / along.squaredNorm(), 0.0, 1.0);
      largest = std::max(largest, (at - t * along).norm());
    }
  }
  return largest;
}

}  // namespace

void MeasureLoop(const Surface& surface, const Density& density, LoopPlan* plan) {
  double arc = 0.0;
  double length = 0.0;
  double weighed_density = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const std::int32_t h : plan->half_edges) {
    plan->start.push_back(arc);
    const Eigen::Vector3d& a = surface.positions()[surface.Origin(h)];
    const Eigen::Vector3d& b = surface.positions()[surface.Target(h)];
    const double edge = (b - a).norm();
    Eigen::Vector3d middle = Eigen::Vector3d::Constant(0.5);
    middle[(h % 3 + 2) % 3] = 0.0;
    const double rho = density.At(h / 3, middle, edge * edge);
    center += (a + b) * (0.5 * edge);
    plan->rate.push_back(std::sqrt(rho));
    arc += plan->rate.back() * edge;
    length += edge;
    weighed_density += rho * edge;
  }
  plan->length = arc;
  if (length > 0.0) center /= length;
  for (const std::int32_t h : plan->half_edges) {
    plan->hole_capacity += 0.5 * (surface.positions()[surface.Origin(h)] - center)
                                     .cross(surface.positions()[surface.Target(h)] - center)
                                     .norm();
  }
  if (length > 0.0) plan->hole_capacity *= weighed_density / length;
}

SurfacePoint PointAt(const Surface& surface, const LoopPlan& loop, double arc) {
  const std::ptrdiff_t i = loop.Segment(arc);
  const double begin = loop.start[i];
  const double end =
      i + 1 < static_cast<std::ptrdiff_t>(loop.start.size()) ? loop.start[i + 1] : loop.length;
  const double t = end > begin ? std::clamp((arc - begin) / (end - begin), 0.0, 1.0) : 0.0;
  const std::int32_t h = loop.half_edges[i];
  SurfacePoint point;
  point.face = h / 3;
  point.weights[h % 3] = 1.0 - t;
  point.weights[(h % 3 + 1) % 3] = t;
  point.position = (1.0 - t) * surface.positions()[surface.Origin(h)] +
                   t * surface.positions()[surface.Target(h)];
  return point;
}

std::vector<double> FindCorners(const Surface& surface, const LoopPlan& loop,
                                const std::vector<std::uint8_t>& is_corner, double side,
                                Interrupt* interrupt) {
  const double reach = std::min(0.5 * side, loop.length / 16.0);
  const auto wrap = [&](double arc) {
    return arc < 0.0 ? arc + loop.length : arc >= loop.length ? arc - loop.length : arc;
  };
  std::vector<std::pair<double, double>> turns;  // (-turn, arc)
  std::vector<double> corners;
  for (std::size_t i = 0; i < loop.start.size(); ++i) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(i))) return corners;
    const double arc = loop.start[i];
    if (is_corner[surface.Origin(loop.half_edges[i])]) {
      corners.push_back(arc);
      continue;
    }
    const Eigen::Vector3d here = PointAt(surface, loop, arc).position;
    const Eigen::Vector3d before = here - PointAt(surface, loop, wrap(arc - reach)).position;
    const Eigen::Vector3d after = PointAt(surface, loop, wrap(arc + reach)).position - here;
    const double turn = AngleBetween(before, after);
    if (turn > kCornerTurn) turns.emplace_back(-turn, arc);
  }
  std::sort(turns.begin(), turns.end());
  ArcSet taken(loop.length, corners);
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(i))) return corners;
    const double arc = turns[i].second;
    if (taken.HasNear(arc, 0.75 * side)) continue;
    corners.push_back(arc);
    taken.Insert(arc);
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

std::int64_t CountOnLoop(const LoopPlan& loop, const std::vector<double>& corners, double side) {
  if (corners.empty()) return std::max<std::int64_t>(3, RoundedCount(loop.length, side));
  std::int64_t total = 0;
  ForEachPiece(loop, corners, side, [&](double, double, std::int64_t count) {
    total = std::min(total + count, kCountCap);
  });
  return total;
}

void PlaceOnLoop(const std::vector<double>& corners, double side, double offset, LoopPlan* loop) {
  loop->arcs.clear();
  loop->fixed.clear();
  if (corners.empty()) {
    const std::int64_t count = CountOnLoop(*loop, corners, side);
    for (std::int64_t i = 0; i < count; ++i) {
      loop->arcs.push_back(loop->length * (static_cast<double>(i) + offset) /
                           static_cast<double>(count));
      loop->fixed.push_back(0);
    }
    return;
  }
  ForEachPiece(*loop, corners, side, [&](double begin, double end, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
      double arc = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count);
      if (arc >= loop->length) arc -= loop->length;
      loop->arcs.push_back(arc);
      loop->fixed.push_back(i == 0);
    }
  });
  // Wrapping around may have put the last ones first.
  std::vector<std::size_t> order(loop->arcs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return loop->arcs[a] < loop->arcs[b]; });
  std::vector<double> arcs;
  std::vector<std::uint8_t> fixed;
  arcs.reserve(order.size());
  fixed.reserve(order.size());
  for (const std::size_t i : order) {
    arcs.push_back(loop->arcs[i]);
    fixed.push_back(loop->fixed[i]);
  }
  loop->arcs = std::move(arcs);
  loop->fixed = std::move(fixed);
}

std::int64_t PiecesOf(const Surface& surface, const LoopPlan& crease, double side,
                      std::int64_t least, std::int64_t limit, Interrupt* interrupt) {
  std::int64_t pieces = std::max(least, RoundedCount(crease.length, side));
  const double most = std::floor(crease.length / (kClosest * side));
  while (pieces <= limit && static_cast<double>(pieces) < most && !interrupt->Requested() &&
         SagOf(surface, crease, pieces, interrupt) > kLargestSag * surface.diagonal()) {
    pieces += std::max<std::int64_t>(1, pieces / 16);
  }
  return pieces;
}

void PlaceOnCrease(const Surface& surface, std::int64_t pieces, CornerSet* corners,
                   LoopPlan* crease) {
  crease->arcs.clear();
  crease->fixed.clear();
  const std::int32_t first = surface.Origin(crease->half_edges.front());
  const std::int32_t last = surface.Target(crease->half_edges.back());
  const auto add = [&](double arc, bool fixed) {
    crease->arcs.push_back(arc);
    crease->fixed.push_back(fixed);
  };
  if (std::exchange(corners->has_sample[first], 1) == 0) add(0.0, true);
  for (std::int64_t i = 1; i < pieces; ++i) {
    add(crease->length * static_cast<double>(i) / static_cast<double>(pieces), false);
  }
  if (std::exchange(corners->has_sample[last], 1) == 0) add(crease->length, true);
}

}  // namespace ccst::internal
