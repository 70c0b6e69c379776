#include "core/sampling/start/plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/density/share_out.h"
#include "core/random/random.h"
#include "core/sampling/start/loop_samples.h"

namespace ccst::internal {
namespace {

/// Steps in which the spacing along loops and the number of triangles come to agree.
constexpr int kSpacingSteps = 8;
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

/// Side of an equilateral triangle of the given area.
double SideOf(double area) { return std::sqrt(4.0 * area / std::sqrt(3.0)); }

/// The lines between corners, by their two ends.
using LinesBetween = std::map<std::pair<std::int32_t, std::int32_t>, int>;

std::pair<std::int32_t, std::int32_t> EndsOf(const Surface& surface,
                                             const std::vector<std::int32_t>& half_edges) {
  const std::int32_t first = surface.Origin(half_edges.front());
  const std::int32_t last = surface.Target(half_edges.back());
  return {std::min(first, last), std::max(first, last)};
}

void GroupLoops(std::size_t component_count, Plan* plan) {
  plan->loop_starts.assign(component_count + 1, 0);
  for (const LoopPlan& loop : plan->loops) ++plan->loop_starts[loop.component + 1];
  std::partial_sum(plan->loop_starts.begin(), plan->loop_starts.end(), plan->loop_starts.begin());
  std::vector<std::size_t> fill(plan->loop_starts.begin(), plan->loop_starts.end() - 1);
  plan->loop_order.resize(plan->loops.size());
  for (std::size_t l = 0; l < plan->loops.size(); ++l) {
    plan->loop_order[fill[plan->loops[l].component]++] = static_cast<std::int32_t>(l);
  }
}

/// Samples on the loops and creases of one component. Numbers of them are found, and compared with
/// what the component has, before any is placed: on a thin surface a loop may be a billion times
/// as long as the spacing.
class LinePlacement {
 public:
  LinePlacement(const Surface& surface, const LinesBetween& lines_between, std::uint64_t seed,
                std::int64_t euler, double covered, Interrupt* interrupt, CornerSet* corners,
                ComponentPlan* component)
      : surface_(surface),
        lines_between_(lines_between),
        random_(seed, kLoopStream),
        euler_(euler),
        covered_(covered),
        interrupt_(*interrupt),
        corners_(*corners),
        component_(*component) {}

  /// @param index  of the loop in the plan.
  void Add(std::int32_t index, LoopPlan* loop) {
    (loop->crease ? creases_ : rims_).push_back({index, loop, {}});
  }

  /// Triangles: F = 2 V - b - 2 chi + 2 per loop already in chi.
  std::int64_t Triangles() const {
    return 2 * component_.samples - component_.boundary_samples - 2 * euler_;
  }

  /// Samples on loops and creases.
  std::int64_t Held() const { return component_.boundary_samples + component_.crease_samples; }

  bool Fits() const { return Held() <= component_.samples && Triangles() >= 1; }

  /// Counts, and places when they fit. Unfinished when interrupted.
  void Run() {
    FindSpacing();
    if (interrupt_.Requested()) return;
    component_.crease_samples = LeastOnCreases();
    if (!Fits()) return;
    PlaceOnRims();
    PlaceOnCreases();
  }

 private:
  struct Line {
    std::int32_t index;
    LoopPlan* loop;
    std::vector<double> corners;  // Of a rim.
  };

  /// Spacing along the loops depends on the number of triangles and that on the loops' samples, so
  /// repeat until they agree.
  void FindSpacing() {
    for (int step = 0; step < kSpacingSteps; ++step) {
      side_ = SideOf(covered_ / static_cast<double>(std::max<std::int64_t>(1, Triangles())));
      std::int64_t total = 0;
      for (Line& rim : rims_) {
        rim.corners = FindCorners(surface_, *rim.loop, corners_.is_corner, side_, &interrupt_);
        if (interrupt_.Requested()) return;
        total = std::min(total + CountOnLoop(*rim.loop, rim.corners, side_), kCountCap);
      }
      if (total == component_.boundary_samples) return;
      component_.boundary_samples = total;
    }
  }

  /// Least number of pieces of a crease. A line back to its own corner takes two more samples to be
  /// one; of several lines between two corners all but one need a sample to differ.
  std::int64_t LeastPieces(const LoopPlan& crease) const {
    if (!crease.open) return 3;
    const auto ends = EndsOf(surface_, crease.half_edges);
    return ends.first == ends.second ? 3 : lines_between_.at(ends) == 1 ? 1 : 2;
  }

  /// A lower bound of the samples on the creases that costs nothing.
  std::int64_t LeastOnCreases() {
    std::int64_t total = 0;
    for (const Line& crease : creases_) {
      const std::int64_t pieces =
          PiecesOf(surface_, *crease.loop, side_, LeastPieces(*crease.loop), 0, &interrupt_);
      total = std::min(total + pieces - (crease.loop->open ? 1 : 0), kCountCap);
    }
    return total;
  }

  void PlaceOnRims() {
    for (Line& rim : rims_) {
      PlaceOnLoop(rim.corners, side_, OffsetOf(rim), rim.loop);
      if (corners_.has_sample.empty()) continue;
      for (const std::int32_t h : rim.loop->half_edges) {
        const std::int32_t v = surface_.Origin(h);
        corners_.has_sample[v] |= corners_.is_corner[v];
      }
    }
  }

  void PlaceOnCreases() {
    component_.crease_samples = 0;
    for (const Line& crease : creases_) {
      LoopPlan& loop = *crease.loop;
      const std::int64_t limit = component_.samples - Held();
      const std::int64_t pieces =
          PiecesOf(surface_, loop, side_, LeastPieces(loop), limit + 1, &interrupt_);
      if (interrupt_.Requested()) return;
      if (pieces > limit + 1) {
        component_.crease_samples = std::min(component_.crease_samples + pieces - 1, kCountCap);
        return;
      }
      if (loop.open) {
        PlaceOnCrease(surface_, pieces, &corners_, &loop);
      } else {
        PlaceOnLoop({}, loop.length / static_cast<double>(pieces), OffsetOf(crease), &loop);
      }
      component_.crease_samples += static_cast<std::int64_t>(loop.arcs.size());
    }
  }

  double OffsetOf(const Line& line) const {
    return random_.Uniform(static_cast<std::uint64_t>(line.index));
  }

  const Surface& surface_;
  const LinesBetween& lines_between_;
  const CounterRandom random_;
  const std::int64_t euler_;
  const double covered_;
  Interrupt& interrupt_;
  CornerSet& corners_;
  ComponentPlan& component_;
  std::vector<Line> rims_;
  std::vector<Line> creases_;
  double side_ = 0.0;
};

absl::Status TooSmall(std::int64_t count) {
  return MakeError(
      absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
      absl::StrCat("sample_count ", count, " is too small for the topology of the surface"));
}

}  // namespace

absl::StatusOr<Plan> MakePlan(const Surface& surface, const Density& density,
                              const std::vector<Crease>& creases, std::int64_t count,
                              std::uint64_t seed, std::int64_t* smallest, Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  const auto stopped = [&] { return interrupt->Error("samples were shared out"); };
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
    if (interrupt->RequestedAfter(static_cast<std::int64_t>(loops[l].half_edges.size()))) {
      return stopped();
    }
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
  corners.has_sample.assign(creases.empty() ? 0 : surface.vertex_count(), 0);
  LinesBetween lines_between;
  for (const Crease& crease : creases) {
    if (interrupt->RequestedAfter(static_cast<std::int64_t>(crease.half_edges.size()))) {
      return stopped();
    }
    LoopPlan& line = plan.loops.emplace_back();
    line.half_edges = crease.half_edges;
    line.component = crease.component;
    line.crease = true;
    line.open = !crease.closed;
    MeasureLoop(surface, density, &line);
    if (crease.closed) continue;
    const auto ends = EndsOf(surface, crease.half_edges);
    corners.is_corner[ends.first] = corners.is_corner[ends.second] = 1;
    ++lines_between[ends];
  }
  GroupLoops(component_count, &plan);
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
    if (interrupt->RequestedAt(static_cast<std::int64_t>(c))) return stopped();
    ComponentPlan& component = plan.components[c];
    component.samples = shares[c];
    if (component.samples < least[c]) {
      plan.MakePoints(static_cast<std::int32_t>(c));
      continue;
    }
    double covered = capacities[c];
    for (const std::int32_t l : plan.LoopsOf(static_cast<std::int32_t>(c))) {
      if (plan.loops[l].closed) covered += plan.loops[l].hole_capacity;
    }
    LinePlacement lines(surface, lines_between, seed, euler[c], covered, interrupt, &corners,
                        &component);
    for (const std::int32_t l : plan.LoopsOf(static_cast<std::int32_t>(c))) {
      if (!plan.loops[l].closed) lines.Add(l, &plan.loops[l]);
    }
    lines.Run();
    if (interrupt->Requested()) return stopped();
    if (!lines.Fits()) {
      if (component_count > 1) {
        plan.MakePoints(static_cast<std::int32_t>(c));
        continue;
      }
      *smallest = std::max(
          count + 1, static_cast<std::int64_t>(
                         std::ceil(static_cast<double>(lines.Held() + 1) * area / capacities[c])));
      return TooSmall(count);
    }
    component.triangles = lines.Triangles();
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
  for (const std::int32_t l : LoopsOf(c)) {
    LoopPlan& loop = loops[l];
    closed_loops -= loop.closed;
    loop.closed = false;
    loop.arcs.clear();
    loop.fixed.clear();
  }
}

SurfacePoint PointOnLoop(const Surface& surface, const Plan& plan, std::int32_t index, double arc) {
  return PointAt(surface, plan.loops[index], arc);
}

}  // namespace ccst::internal
