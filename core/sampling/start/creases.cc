#include "core/sampling/start/creases.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

#include "core/surface/frame.h"

namespace ccst::internal {
namespace {

constexpr double kCornerTurn = 45.0 * std::numbers::pi / 180.0;

class Finder {
 public:
  Finder(const Surface& surface, double angle, Interrupt* interrupt)
      : surface_(surface), interrupt_(*interrupt) {
    const auto count = static_cast<std::int32_t>(surface.twins().size());
    sharp_.assign(count, 0);
    for (std::int32_t h = 0; h < count && !interrupt_.RequestedAt(h); ++h) {
      const std::int32_t g = surface.twins()[h];
      if (g < 0 || h > g) continue;
      if (!(surface.face_areas()[h / 3] > 0.0) || !(surface.face_areas()[g / 3] > 0.0)) continue;
      const double turn = AngleBetween(surface.FaceCross(h / 3), surface.FaceCross(g / 3));
      sharp_[h] = sharp_[g] = turn > angle;
    }
  }

  /// Leaves out connected lines that are too short.
  void Drop(double least_length) {
    std::vector<std::int32_t> group(surface_.vertex_count());
    std::iota(group.begin(), group.end(), 0);
    const auto root = [&](std::int32_t v) {
      while (group[v] != v) v = group[v] = group[group[v]];
      return v;
    };
    ForEachSharpEdge(
        [&](std::int32_t h) { group[root(surface_.Origin(h))] = root(surface_.Target(h)); });
    std::vector<double> length(surface_.vertex_count(), 0.0);
    ForEachSharpEdge([&](std::int32_t h) { length[root(surface_.Origin(h))] += Along(h).norm(); });
    for (std::size_t h = 0; h < sharp_.size(); ++h) {
      const auto half_edge = static_cast<std::int32_t>(h);
      if (sharp_[h] && length[root(surface_.Origin(half_edge))] < least_length) sharp_[h] = 0;
    }
  }

  std::vector<Crease> Run() {
    CollectLeaving();
    std::vector<Crease> creases;
    used_.assign(sharp_.size(), 0);
    for (std::int32_t v = 0; v < surface_.vertex_count() && !interrupt_.RequestedAt(v); ++v) {
      if (start_[v] == start_[v + 1] || !IsCorner(v)) continue;
      for (std::int32_t i = start_[v]; i < start_[v + 1]; ++i) {
        if (!used_[leaving_[i]]) creases.push_back(Walk(leaving_[i]));
      }
    }
    ForEachSharpEdge([&](std::int32_t h) {
      if (used_[h] || interrupt_.RequestedAfter(1)) return;
      creases.push_back(Walk(h));
      creases.back().closed = true;
    });
    return creases;
  }

 private:
  template <typename F>
  void ForEachSharpEdge(F&& f) const {
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(sharp_.size()); ++h) {
      if (sharp_[h] && h < surface_.twins()[h]) f(h);
    }
  }

  Eigen::Vector3d Along(std::int32_t h) const {
    return surface_.positions()[surface_.Target(h)] - surface_.positions()[surface_.Origin(h)];
  }

  /// Sharp half-edges by the vertex they leave.
  void CollectLeaving() {
    start_.assign(surface_.vertex_count() + 1, 0);
    for (std::size_t h = 0; h < sharp_.size(); ++h) {
      if (sharp_[h]) ++start_[surface_.Origin(static_cast<std::int32_t>(h)) + 1];
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    leaving_.resize(start_.back());
    std::vector<std::int32_t> fill(start_.begin(), start_.end() - 1);
    for (std::size_t h = 0; h < sharp_.size(); ++h) {
      const auto half_edge = static_cast<std::int32_t>(h);
      if (sharp_[h]) leaving_[fill[surface_.Origin(half_edge)]++] = half_edge;
    }
  }

  bool IsCorner(std::int32_t v) const {
    if (start_[v + 1] - start_[v] != 2) return true;
    if (surface_.twins()[surface_.outgoing()[v]] < 0) return true;
    return AngleBetween(-Along(leaving_[start_[v]]), Along(leaving_[start_[v] + 1])) > kCornerTurn;
  }

  /// From `h` to the next corner, or around.
  Crease Walk(std::int32_t h) {
    Crease crease;
    crease.component = surface_.face_components()[h / 3];
    while (true) {
      crease.half_edges.push_back(h);
      used_[h] = used_[surface_.twins()[h]] = 1;
      const std::int32_t v = surface_.Target(h);
      if (IsCorner(v)) return crease;
      const std::int32_t first = leaving_[start_[v]];
      h = used_[first] ? leaving_[start_[v] + 1] : first;
      if (used_[h]) return crease;
    }
  }

  const Surface& surface_;
  Interrupt& interrupt_;
  std::vector<std::uint8_t> sharp_;  // Per half-edge.
  std::vector<std::uint8_t> used_;
  std::vector<std::int32_t> start_;  // Per vertex, into leaving_.
  std::vector<std::int32_t> leaving_;
};

}  // namespace

std::vector<Crease> FindCreases(const Surface& surface, double angle, double least_length,
                                Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  Finder finder(surface, angle, interrupt);
  if (interrupt->Requested()) return {};
  finder.Drop(least_length);
  if (interrupt->Requested()) return {};
  return finder.Run();
}

}  // namespace ccst::internal
