#include "core/sampling/plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/methods/strata.h"
#include "core/random/random.h"

namespace ccst {
namespace {

constexpr double kCornerTurn = 60.0 * std::numbers::pi / 180.0;
/// Farthest that a crease may lie from the chords between its samples, over the diagonal, as long
/// as they need not be closer than kClosest times their usual distance for it.
constexpr double kLargestSag = 7e-4;
constexpr double kClosest = 0.7;
constexpr std::uint64_t kLoopStream = 0x6c6f6f70;  // "loop"

/// Smallest number of vertices of a triangulated surface of the given kind; for closed surfaces
/// by Ringel and by Jungerman and Ringel, 1980 (genus 2 is the exception).
std::int64_t SmallestCount(std::int64_t euler, std::int64_t loops) {
  if (loops > 0) return std::max<std::int64_t>(3 * loops, loops == 1 && euler == 1 ? 3 : 6);
  if (euler >= 2) return 4;
  if (euler == -2) return 10;
  return static_cast<std::int64_t>(
      std::ceil((7.0 + std::sqrt(49.0 - 24.0 * static_cast<double>(euler))) / 2.0));
}

/// Point of a loop at arc length `arc`.
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

/// Side of an equilateral triangle of the given area.
double SideOf(double area) { return std::sqrt(4.0 * area / std::sqrt(3.0)); }

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

/// Arc lengths of the loop's corners: vertices at which it turns by more than kCornerTurn between
/// the chords to half a spacing before and after, so that the zigzag of a scan's rim is none. Of
/// several nearer than 3/4 of a spacing the sharpest counts. Ends of creases always do.
std::vector<double> FindCorners(const Surface& surface, const Plan& plan,
                                const std::vector<std::uint8_t>& is_corner, std::int32_t index,
                                double side) {
  const LoopPlan& loop = plan.loops[index];
  const double reach = std::min(0.5 * side, loop.length / 16.0);
  const auto wrap = [&](double arc) {
    return arc < 0.0 ? arc + loop.length : arc >= loop.length ? arc - loop.length : arc;
  };
  std::vector<std::pair<double, double>> turns;  // (-turn, arc)
  std::vector<double> corners;
  for (std::size_t i = 0; i < loop.start.size(); ++i) {
    const double arc = loop.start[i];
    if (is_corner[surface.Origin(loop.half_edges[i])]) {
      corners.push_back(arc);
      continue;
    }
    const Eigen::Vector3d here = PointOnLoop(surface, plan, index, arc).position;
    const Eigen::Vector3d before =
        here - PointOnLoop(surface, plan, index, wrap(arc - reach)).position;
    const Eigen::Vector3d after =
        PointOnLoop(surface, plan, index, wrap(arc + reach)).position - here;
    const double turn = std::atan2(before.cross(after).norm(), before.dot(after));
    if (turn > kCornerTurn) turns.emplace_back(-turn, arc);
  }
  std::sort(turns.begin(), turns.end());
  for (const auto& [turn, arc] : turns) {
    const bool crowded = std::any_of(corners.begin(), corners.end(), [&, at = arc](double other) {
      const double gap = std::abs(at - other);
      return std::min(gap, loop.length - gap) < 0.75 * side;
    });
    if (!crowded) corners.push_back(arc);
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Spreads about length / side samples over the loop, evenly between corners.
void PlaceOnLoop(const std::vector<double>& corners, double side, double offset, LoopPlan* loop) {
  loop->arcs.clear();
  loop->fixed.clear();
  if (corners.empty()) {
    const auto count = std::max<std::int64_t>(3, std::llround(loop->length / side));
    for (std::int64_t i = 0; i < count; ++i) {
      loop->arcs.push_back(loop->length * (static_cast<double>(i) + offset) /
                           static_cast<double>(count));
      loop->fixed.push_back(0);
    }
    return;
  }
  const auto pieces = static_cast<std::int64_t>(corners.size());
  for (std::int64_t c = 0; c < pieces; ++c) {
    const double begin = corners[c];
    const double end = c + 1 < pieces ? corners[c + 1] : corners[0] + loop->length;
    const std::int64_t least = pieces == 1 ? 3 : pieces == 2 ? 2 : 1;
    const auto count = std::max<std::int64_t>(least, std::llround((end - begin) / side));
    for (std::int64_t i = 0; i < count; ++i) {
      double arc = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count);
      if (arc >= loop->length) arc -= loop->length;
      loop->arcs.push_back(arc);
      loop->fixed.push_back(i == 0);
    }
  }
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

/// What is known of the ends of creases.
struct CornerSet {
  std::vector<std::uint8_t> is_corner;  ///< Per vertex of the surface.
  std::vector<std::uint8_t> has_sample;
};

/// Largest distance of the crease from `pieces` chords between evenly spread samples.
double SagOf(const Surface& surface, const LoopPlan& crease, std::int64_t pieces) {
  double largest = 0.0;
  std::size_t next = 0;  // The vertices of the line, by arc.
  for (std::int64_t i = 0; i < pieces; ++i) {
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

/// Into how many pieces samples divide a crease: about `side` long, shorter where it is bent.
std::int64_t PiecesOf(const Surface& surface, const LoopPlan& crease, double side,
                      std::int64_t least) {
  std::int64_t pieces = std::max<std::int64_t>(least, std::llround(crease.length / side));
  const auto most = static_cast<std::int64_t>(crease.length / (kClosest * side));
  while (pieces < most && SagOf(surface, crease, pieces) > kLargestSag * surface.diagonal()) {
    pieces += std::max<std::int64_t>(1, pieces / 16);
  }
  return pieces;
}

/// Spreads samples over a crease between two corners, which get one where they have none yet.
void PlaceOnCrease(const Surface& surface, double side, bool only_one, CornerSet* corners,
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
  // A line back to its own corner takes two more samples to be one; of several lines between two
  // corners all but one need a sample to differ.
  const std::int64_t least = first == last ? 3 : only_one ? 1 : 2;
  const std::int64_t pieces = PiecesOf(surface, *crease, side, least);
  for (std::int64_t i = 1; i < pieces; ++i) {
    add(crease->length * static_cast<double>(i) / static_cast<double>(pieces), false);
  }
  if (std::exchange(corners->has_sample[last], 1) == 0) add(crease->length, true);
}

absl::Status TooSmall(std::int64_t count) {
  return MakeError(
      absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
      absl::StrCat("sample_count ", count, " is too small for the topology of the surface"));
}

}  // namespace

absl::StatusOr<Plan> MakePlan(const Surface& surface, const Density& density,
                              const std::vector<Crease>& creases, std::int64_t count,
                              std::uint64_t seed, std::int64_t* smallest) {
  Plan plan;
  const double area = surface.area();
  plan.spacing = std::sqrt(2.0 * area / (std::sqrt(3.0) * static_cast<double>(count)));
  const std::vector<BoundaryLoop>& loops = surface.boundary_loops();
  const std::size_t component_count = surface.component_areas().size();
  plan.loops.resize(loops.size());
  std::vector<std::int64_t> open_loops(component_count, 0);
  std::vector<std::int64_t> euler = surface.component_eulers();
  const std::vector<double>& capacities = density.component_capacities();
  for (std::size_t l = 0; l < loops.size(); ++l) {
    plan.loops[l].half_edges = loops[l].half_edges;
    plan.loops[l].component = loops[l].component;
    MeasureLoop(surface, density, &plan.loops[l]);
    plan.loops[l].closed = plan.loops[l].length < 3.0 * plan.spacing &&
                           plan.loops[l].hole_capacity < 0.5 * capacities[loops[l].component];
    if (plan.loops[l].closed) {
      ++plan.closed_loops;
      ++euler[loops[l].component];
    } else {
      ++open_loops[loops[l].component];
    }
  }
  CornerSet corners;
  corners.is_corner.assign(surface.vertex_count(), 0);
  std::map<std::pair<std::int32_t, std::int32_t>, int> lines_between;
  for (const Crease& crease : creases) {
    LoopPlan& line = plan.loops.emplace_back();
    line.half_edges = crease.half_edges;
    line.component = crease.component;
    line.crease = true;
    line.open = !crease.closed;
    MeasureLoop(surface, density, &line);
    if (crease.closed) continue;
    const std::int32_t first = surface.Origin(crease.half_edges.front());
    const std::int32_t last = surface.Target(crease.half_edges.back());
    corners.is_corner[first] = corners.is_corner[last] = 1;
    ++lines_between[std::minmax({first, last})];
  }
  std::vector<std::int64_t> least(component_count);
  for (std::size_t c = 0; c < component_count; ++c) {
    least[c] = SmallestCount(euler[c], open_loops[c]);
  }
  if (component_count == 1 && count < least[0]) {
    *smallest = least[0];
    return TooSmall(count);
  }
  const std::vector<std::int64_t> shares = ShareOut(count, capacities);

  plan.components.resize(component_count);
  for (std::size_t c = 0; c < component_count; ++c) {
    ComponentPlan& component = plan.components[c];
    component.samples = shares[c];
    if (component.samples < least[c]) {
      plan.MakePoints(static_cast<std::int32_t>(c));
      continue;
    }
    double covered = capacities[c];
    std::vector<std::size_t> own;
    for (std::size_t l = 0; l < plan.loops.size(); ++l) {
      if (plan.loops[l].component != static_cast<std::int32_t>(c)) continue;
      if (plan.loops[l].closed) {
        covered += plan.loops[l].hole_capacity;
      } else {
        own.push_back(l);
      }
    }
    // Triangles: F = 2 V - b - 2 chi + 2 per loop already in chi; spacing along the loops depends
    // on F and F on the loops' samples, so repeat until they agree.
    const auto triangles = [&] {
      return 2 * component.samples - component.boundary_samples - 2 * euler[c];
    };
    for (int step = 0; step < 8; ++step) {
      const double side =
          SideOf(covered / static_cast<double>(std::max<std::int64_t>(1, triangles())));
      std::int64_t total = 0;
      component.crease_samples = 0;
      corners.has_sample.assign(creases.empty() ? 0 : surface.vertex_count(), 0);
      for (const std::size_t l : own) {
        LoopPlan& loop = plan.loops[l];
        const double offset = CounterRandom(seed, kLoopStream).Uniform(l);
        if (loop.open) {
          // By value: the ends are temporaries.
          const std::pair<std::int32_t, std::int32_t> ends = std::minmax(
              {surface.Origin(loop.half_edges.front()), surface.Target(loop.half_edges.back())});
          PlaceOnCrease(surface, side, lines_between[ends] == 1, &corners, &loop);
        } else if (loop.crease) {
          const auto pieces = static_cast<double>(PiecesOf(surface, loop, side, 3));
          PlaceOnLoop({}, loop.length / pieces, offset, &loop);
        } else {
          PlaceOnLoop(
              FindCorners(surface, plan, corners.is_corner, static_cast<std::int32_t>(l), side),
              side, offset, &loop);
          total += static_cast<std::int64_t>(loop.arcs.size());
          if (creases.empty()) continue;
          for (const std::int32_t h : loop.half_edges) {
            const std::int32_t v = surface.Origin(h);
            corners.has_sample[v] |= corners.is_corner[v];
          }
        }
        if (loop.crease) component.crease_samples += static_cast<std::int64_t>(loop.arcs.size());
      }
      if (total == component.boundary_samples) break;
      component.boundary_samples = total;
    }
    const std::int64_t held = component.boundary_samples + component.crease_samples;
    if (held > component.samples || triangles() < 1) {
      if (component_count > 1) {
        plan.MakePoints(static_cast<std::int32_t>(c));
        continue;
      }
      *smallest = std::max(count + 1, static_cast<std::int64_t>(std::ceil(
                                          static_cast<double>(held + 1) * area / capacities[c])));
      return TooSmall(count);
    }
    component.triangles = triangles();
    component.target = covered / static_cast<double>(component.triangles);
  }
  return plan;
}

std::ptrdiff_t LoopPlan::Segment(double arc) const {
  const auto after = std::upper_bound(start.begin(), start.end(), arc);
  return std::max<std::ptrdiff_t>(0, after - start.begin() - 1);
}

void Plan::MakePoints(std::int32_t c) {
  components[c].points = true;
  components[c].boundary_samples = 0;
  components[c].crease_samples = 0;
  components[c].triangles = 0;
  for (LoopPlan& loop : loops) {
    if (loop.component != c) continue;
    closed_loops -= loop.closed;
    loop.closed = false;
    loop.arcs.clear();
    loop.fixed.clear();
  }
}

SurfacePoint PointOnLoop(const Surface& surface, const Plan& plan, std::int32_t index, double arc) {
  return PointAt(surface, plan.loops[index], arc);
}

}  // namespace ccst
