#include "core/sampling/relax/relocation.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace ccst::internal {
namespace {

/// One call of Relocate().
class Relocation {
 public:
  Relocation(Projection* projection, GeometryPhase* geometry, EdgeFlips* flips)
      : projection_(*projection),
        geometry_(*geometry),
        packed_(geometry->packed()),
        flips_(*flips),
        mesh_(packed_.mesh()),
        samples_(packed_.samples()),
        busy_(samples_.count(), 0) {}

  /// Keeps the samples around `v` out of further changes: their rings are not settled.
  void Reserve(std::int32_t v) {
    busy_[v] = 1;
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
      busy_[mesh_.Target(h)] = 1;
      busy_[mesh_.Apex(h)] = 1;
    });
  }

  bool IsBusy(std::int32_t v) const { return busy_[v] != 0; }

  /// Triangles with room for another sample, by capacity, largest first; ties by index. Of those
  /// looked at when `interrupt` was requested.
  std::vector<TriangleIndex> FindRoom(std::size_t count, Interrupt* interrupt) const {
    count = std::min(count, static_cast<std::size_t>(mesh_.triangle_count()));
    // Never many more than asked for: of a mesh of millions they would be most of the memory.
    std::vector<std::pair<double, std::int32_t>> order;
    const auto keep_largest = [&] {
      const auto end = order.begin() + static_cast<std::ptrdiff_t>(count);
      if (end < order.end()) std::nth_element(order.begin(), end, order.end());
      order.resize(std::min(order.size(), count));
    };
    for (std::int32_t t = 0; t < mesh_.triangle_count() && !interrupt->RequestedAt(t); ++t) {
      order.emplace_back(-geometry_.Capacity(TriangleIndex(t)), t);
      if (order.size() >= 2 * count + 256) keep_largest();
    }
    keep_largest();
    std::sort(order.begin(), order.end());
    std::vector<TriangleIndex> triangles;
    triangles.reserve(order.size());
    for (const auto& [capacity, t] : order) triangles.emplace_back(t);
    return triangles;
  }

  /// A large triangle at a boundary, a tip or a crease may have no room for another sample.
  bool HasRoom(TriangleIndex t, std::int32_t component) const {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = mesh_.origin[3 * t + k];
      if (IsBusy(v) || samples_.kind[v] != SampleMesh::Kind::kInterior ||
          samples_.component[v] != component) {
        return false;
      }
    }
    return Facing(samples_.position, samples_.normal, mesh_.origin[3 * t], mesh_.origin[3 * t + 1],
                  mesh_.origin[3 * t + 2]) >= 0.9;
  }

  /// Merges `v` into the neighbour that leaves the best-facing, roundest triangles.
  /// @return false when none would keep the topology. The triangles that fell free are slots.
  bool TakeOut(std::int32_t v, std::array<TriangleIndex, 2>* slots) {
    ring_.clear();
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) { ring_.push_back(h); });
    double best = -2.0;
    std::int32_t chosen = -1;
    for (const std::int32_t h : ring_) {
      const double worst = WorstAfter(h);
      if (worst > best && mesh_.CanCollapse(h)) {
        best = worst;
        chosen = h;
      }
    }
    if (chosen < 0) return false;
    const std::int32_t w = mesh_.Target(chosen);
    *slots = {SampleMesh::TriangleOf(chosen), SampleMesh::TriangleOf(mesh_.twin[chosen])};
    packed_.Collapse(chosen);
    flips_.FlipAround(w);
    Reserve(w);
    geometry_.Activate(w);
    return true;
  }

  void PutIn(std::int32_t v, TriangleIndex t, const std::array<TriangleIndex, 2>& slots,
             const SurfacePoint& point) {
    packed_.Insert(v, point, t, slots);
    Reserve(v);
    flips_.FlipAround(v);
    geometry_.Activate(v);
  }

  /// The surface under the centre of triangle `t`.
  SurfacePoint Center(TriangleIndex t) {
    const std::int32_t* corner = &mesh_.origin[3 * t];
    const Eigen::Vector3d center = (samples_.position[corner[0]] + samples_.position[corner[1]] +
                                    samples_.position[corner[2]]) /
                                   3.0;
    const Eigen::Vector3d normal =
        (samples_.normal[corner[0]] + samples_.normal[corner[1]] + samples_.normal[corner[2]])
            .normalized();
    const double edge = (samples_.position[corner[1]] - samples_.position[corner[0]]).norm();
    return projection_.Project(samples_.face[corner[0]], center, normal, 0.25 * edge);
  }

 private:
  double WorstAfter(std::int32_t h) const {
    const std::int32_t w = mesh_.Target(h);
    double worst = 2.0;
    for (const std::int32_t e : ring_) {
      if (mesh_.FallsWith(h, e)) continue;
      const std::int32_t b = mesh_.Target(e);
      const std::int32_t c = mesh_.Apex(e);
      worst = std::min(worst, Facing(samples_.position, samples_.normal, w, b, c) *
                                  (1.0 - SmallestAngleCosine(samples_, w, b, c)));
    }
    return worst;
  }

  Projection& projection_;
  GeometryPhase& geometry_;
  PackedSamples& packed_;
  EdgeFlips& flips_;
  const SampleMesh& mesh_;
  const Samples& samples_;
  std::vector<std::uint8_t> busy_;
  std::vector<std::int32_t> ring_;
};

/// A surface vertex as a point of the surface.
SurfacePoint AtVertex(const Surface& surface, std::int32_t vertex) {
  const std::int32_t h = surface.outgoing()[vertex];
  SurfacePoint point;
  point.face = h / 3;
  point.weights[h % 3] = 1.0;
  point.position = surface.positions()[vertex];
  return point;
}

}  // namespace

std::int64_t Relocate(const std::vector<Defect>& defects,
                      const std::vector<UncoveredPlace>& uncovered, const Surface& surface,
                      Projection* projection, GeometryPhase* geometry, EdgeFlips* flips,
                      Interrupt* interrupt) {
  if (defects.empty() && uncovered.empty()) return 0;
  const SampleMesh& mesh = geometry->packed().mesh();
  const Samples& samples = geometry->packed().samples();
  Relocation relocation(projection, geometry, flips);
  std::vector<std::int32_t> crowded;
  crowded.reserve(defects.size());
  for (const Defect& defect : defects) crowded.push_back(defect.sample);
  for (const std::int32_t v : crowded) relocation.Reserve(v);

  if (crowded.size() < uncovered.size()) {
    std::vector<std::pair<double, std::int32_t>> least;
    for (std::int32_t v = 0; v < samples.count() && !interrupt->RequestedAt(v); ++v) {
      if (samples.kind[v] != SampleMesh::Kind::kInterior || relocation.IsBusy(v)) continue;
      least.emplace_back(RingArea(mesh, samples, v) / mesh.Degree(v), v);
    }
    const std::size_t more = std::min(uncovered.size() - crowded.size(), least.size());
    std::partial_sort(least.begin(), least.begin() + static_cast<std::ptrdiff_t>(more),
                      least.end());
    for (std::size_t i = 0; i < more; ++i) crowded.push_back(least[i].second);
  }

  const std::vector<TriangleIndex> room = relocation.FindRoom(16 * crowded.size() + 256, interrupt);
  std::size_t next_room = 0;
  std::size_t next_place = 0;
  std::int64_t count = 0;
  std::array<TriangleIndex, 2> slots;
  std::int64_t tried = 0;
  for (const std::int32_t v : crowded) {
    if (interrupt->RequestedAt(tried++)) break;
    if (next_place < uncovered.size()) {
      const UncoveredPlace& place = uncovered[next_place];
      const std::int32_t* corner = &mesh.origin[3 * place.triangle];
      const bool usable = corner[0] >= 0 && corner[0] != v && corner[1] != v && corner[2] != v &&
                          samples.component[corner[0]] == samples.component[v];
      if (usable) {
        ++next_place;
        if (!relocation.TakeOut(v, &slots)) continue;
        relocation.PutIn(v, place.triangle, slots, AtVertex(surface, place.vertex));
        ++count;
        continue;
      }
    }
    while (next_room < room.size() && !relocation.HasRoom(room[next_room], samples.component[v])) {
      ++next_room;
    }
    if (next_room == room.size()) break;
    const TriangleIndex t = room[next_room++];
    if (!relocation.TakeOut(v, &slots)) continue;
    relocation.PutIn(v, t, slots, relocation.Center(t));
    ++count;
  }
  return count;
}

}  // namespace ccst::internal
