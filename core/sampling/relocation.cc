#include "core/sampling/relocation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace ccst {
namespace {

/// A sample whose total angle is this much below 2 pi holds a tip [rad].
constexpr double kTipDeficit = 1.3;

double TwiceArea(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  return (samples.position[b] - samples.position[a])
      .cross(samples.position[c] - samples.position[a])
      .norm();
}

/// Sum of the areas around `v`, twice.
double RingArea(const SampleMesh& mesh, const Samples& samples, std::int32_t v) {
  double area = 0.0;
  mesh.ForEachOutgoing(
      v, [&](std::int32_t h) { area += TwiceArea(samples, v, mesh.Target(h), mesh.Apex(h)); });
  return area;
}

/// Sum of the angles at `v`; 2 pi where the sample mesh is flat.
double TotalAngle(const SampleMesh& mesh, const Samples& samples, std::int32_t v) {
  double sum = 0.0;
  mesh.ForEachOutgoing(v, [&](std::int32_t h) {
    const Eigen::Vector3d a = samples.position[mesh.Target(h)] - samples.position[v];
    const Eigen::Vector3d b = samples.position[mesh.Apex(h)] - samples.position[v];
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  });
  return sum;
}

/// Normal of a face, twice its area long.
Eigen::Vector3d FaceCross(const Surface& surface, std::int32_t face) {
  const Eigen::Vector3i& corner = surface.faces()[face];
  return (surface.positions()[corner[1]] - surface.positions()[corner[0]])
      .cross(surface.positions()[corner[2]] - surface.positions()[corner[0]]);
}

/// Vertices up to a number of edges away.
class Neighbourhood {
 public:
  explicit Neighbourhood(const SampleMesh& mesh) : mesh_(mesh), seen_(mesh.vertex_count(), -1) {}

  const std::vector<std::int32_t>& Of(std::int32_t v, int reach) {
    found_.assign(1, v);
    seen_[v] = v;
    std::size_t begin = 0;
    for (int step = 0; step < reach; ++step) {
      const std::size_t end = found_.size();
      for (; begin < end; ++begin) {
        mesh_.ForEachOutgoing(found_[begin], [&](std::int32_t h) {
          for (const std::int32_t u : {mesh_.Target(h), mesh_.Apex(h)}) {
            if (seen_[u] == v) continue;
            seen_[u] = v;
            found_.push_back(u);
          }
        });
      }
    }
    return found_;
  }

 private:
  const SampleMesh& mesh_;
  std::vector<std::int32_t> seen_;
  std::vector<std::int32_t> found_;
};

/// Cosine of the smallest angle of triangle (a, b, c).
double SmallestAngleCosine(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  const Eigen::Vector3d ab = (samples.position[b] - samples.position[a]).normalized();
  const Eigen::Vector3d bc = (samples.position[c] - samples.position[b]).normalized();
  const Eigen::Vector3d ca = (samples.position[a] - samples.position[c]).normalized();
  return std::max({-ab.dot(ca), -bc.dot(ab), -ca.dot(bc)});
}

}  // namespace

std::vector<Defect> FindDefects(const Surface& surface, const Density& density, const Plan& plan,
                                const SampleMesh& mesh, const Samples& samples,
                                const DefectLimits& limits, const DefectLimits& grave,
                                const std::vector<std::uint8_t>& scope, Interrupt* interrupt) {
  std::vector<Defect> found;
  const auto movable = [&](std::int32_t v) {
    return samples.kind[v] == SampleMesh::Kind::kInterior;
  };
  const auto holds_tip = [&](std::int32_t v) {
    return TotalAngle(mesh, samples, v) < 2.0 * std::numbers::pi - kTipDeficit;
  };
  // Of several samples, the one with the least room; one that holds a tip only for want of another.
  const auto blame = [&](std::initializer_list<std::int32_t> candidates, bool is_grave) {
    std::int32_t worst = -1;
    std::pair<bool, double> least;
    for (const std::int32_t v : candidates) {
      if (!movable(v)) continue;
      const std::pair<bool, double> room(holds_tip(v), RingArea(mesh, samples, v));
      if (worst < 0 || room < least) {
        worst = v;
        least = room;
      }
    }
    if (worst >= 0) found.push_back({worst, is_grave});
  };
  const double cosine = limits.least_angle > 0.0 ? std::cos(limits.least_angle) : 2.0;
  const double grave_cosine = grave.least_angle > 0.0 ? std::cos(grave.least_angle) : 2.0;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (interrupt->RequestedAt(t)) break;
    const std::int32_t a = mesh.origin[3 * t];
    const std::int32_t b = mesh.origin[3 * t + 1];
    const std::int32_t c = mesh.origin[3 * t + 2];
    if (!(scope[a] | scope[b] | scope[c])) continue;
    const double facing = Facing(samples.position, samples.normal, a, b, c);
    const double sharpest = cosine <= 1.0 ? SmallestAngleCosine(samples, a, b, c) : 0.0;
    if (facing < limits.least_facing || sharpest > cosine) {
      blame({a, b, c}, facing < grave.least_facing || sharpest > grave_cosine);
    }
  }
  std::vector<double> squared_spacing;  // Per component.
  squared_spacing.reserve(plan.components.size());
  for (const ComponentPlan& component : plan.components) {
    squared_spacing.push_back(4.0 / std::sqrt(3.0) * component.target);
  }
  const double aim = limits.least_separation * limits.least_separation;
  const double floor = grave.least_separation * grave.least_separation;
  const auto check_pair = [&](std::int32_t c, std::int32_t d) {
    double distance = (samples.position[c] - samples.position[d]).squaredNorm() /
                      squared_spacing[samples.component[c]];
    if (!density.uniform()) {
      // Where it changes fast the denser of the two ends decides.
      const double footprint = 0.5 * plan.spacing * plan.spacing;
      distance *= std::max(density.At(samples.face[c], samples.weights[c], footprint),
                           density.At(samples.face[d], samples.weights[d], footprint));
    }
    if (distance < aim &&
        FaceCross(surface, samples.face[c]).dot(FaceCross(surface, samples.face[d])) > 0.0) {
      blame({c, d}, distance < floor);
    }
  };
  if (limits.reach == 0) {
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
      if (interrupt->RequestedAt(h)) break;
      if (mesh.twin[h] > h && scope[mesh.origin[h]]) {
        check_pair(mesh.Apex(h), mesh.Apex(mesh.twin[h]));
      }
    }
  } else {
    Neighbourhood near(mesh);
    for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
      if (interrupt->RequestedAt(v)) break;
      if (!scope[v] || samples.kind[v] == SampleMesh::Kind::kPoint) continue;
      for (const std::int32_t u : near.Of(v, limits.reach)) {
        if (u > v || (u < v && !scope[u])) check_pair(v, u);
      }
    }
  }
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!scope[v] || !movable(v)) continue;
    const std::int32_t degree = mesh.Degree(v);
    if (degree >= 5 && degree <= 7) continue;
    const double regular = TotalAngle(mesh, samples, v) * 3.0 / std::numbers::pi;
    if (std::abs(degree - regular) > limits.most_excess) found.push_back({v, false});
  }
  std::sort(found.begin(), found.end(), [](const Defect& a, const Defect& b) {
    return a.sample != b.sample ? a.sample < b.sample : a.grave > b.grave;
  });
  const auto same = [](const Defect& a, const Defect& b) { return a.sample == b.sample; };
  found.erase(std::unique(found.begin(), found.end(), same), found.end());
  return found;
}

namespace {

/// One call of Relocate().
class Relocation {
 public:
  Relocation(const Surface& surface, Projection* projection, GeometryPhase* geometry,
             EdgeFlips* flips, SampleMesh* mesh, Samples* samples)
      : surface_(surface),
        projection_(*projection),
        geometry_(*geometry),
        flips_(*flips),
        mesh_(*mesh),
        samples_(*samples),
        busy_(samples->count(), 0) {}

  /// Keeps the samples around `v` out of further changes: their rings are not settled.
  void Reserve(std::int32_t v) {
    busy_[v] = 1;
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
      busy_[mesh_.Target(h)] = 1;
      busy_[mesh_.Apex(h)] = 1;
    });
  }

  bool IsBusy(std::int32_t v) const { return busy_[v] != 0; }

  /// Triangles with room for another sample, by capacity, largest first; ties by index.
  std::vector<std::int32_t> FindRoom(std::size_t count) const {
    std::vector<std::pair<double, std::int32_t>> order;
    order.reserve(mesh_.triangle_count());
    for (std::int32_t t = 0; t < mesh_.triangle_count(); ++t) {
      order.emplace_back(-geometry_.Capacity(t), t);
    }
    count = std::min(order.size(), count);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                      order.end());
    order.resize(count);
    std::vector<std::int32_t> triangles;
    triangles.reserve(order.size());
    for (const auto& [capacity, t] : order) triangles.push_back(t);
    return triangles;
  }

  /// A large triangle at a boundary, a tip or a crease may have no room for another sample.
  bool HasRoom(std::int32_t t, std::int32_t component) const {
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
  bool TakeOut(std::int32_t v, std::int32_t slots[2]) {
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
    slots[0] = chosen / 3;
    slots[1] = mesh_.twin[chosen] / 3;
    mesh_.Collapse(chosen);
    flips_.FlipAround(w);
    Reserve(w);
    geometry_.Activate(w);
    return true;
  }

  void PutIn(std::int32_t v, std::int32_t t, const std::int32_t slots[2],
             const SurfacePoint& point) {
    samples_.Place(v, surface_, point);
    mesh_.InsertIntoTriangle(v, t, slots[0], slots[1]);
    Reserve(v);
    flips_.FlipAround(v);
    geometry_.Activate(v);
  }

  /// The surface under the centre of triangle `t`.
  SurfacePoint Center(std::int32_t t) {
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
    const std::int32_t g = mesh_.twin[h];
    double worst = 2.0;
    for (const std::int32_t e : ring_) {
      if (e == h || (g >= 0 && e == SampleMesh::Next(g))) continue;
      const std::int32_t b = mesh_.Target(e);
      const std::int32_t c = mesh_.Apex(e);
      worst = std::min(worst, Facing(samples_.position, samples_.normal, w, b, c) *
                                  (1.0 - SmallestAngleCosine(samples_, w, b, c)));
    }
    return worst;
  }

  const Surface& surface_;
  Projection& projection_;
  GeometryPhase& geometry_;
  EdgeFlips& flips_;
  SampleMesh& mesh_;
  Samples& samples_;
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
                      Interrupt* interrupt, SampleMesh* mesh, Samples* samples) {
  if (defects.empty() && uncovered.empty()) return 0;
  Relocation relocation(surface, projection, geometry, flips, mesh, samples);
  std::vector<std::int32_t> crowded;
  crowded.reserve(defects.size());
  for (const Defect& defect : defects) crowded.push_back(defect.sample);
  for (const std::int32_t v : crowded) relocation.Reserve(v);

  if (crowded.size() < uncovered.size()) {
    std::vector<std::pair<double, std::int32_t>> least;
    for (std::int32_t v = 0; v < samples->count(); ++v) {
      if (samples->kind[v] != SampleMesh::Kind::kInterior || relocation.IsBusy(v)) continue;
      least.emplace_back(RingArea(*mesh, *samples, v) / mesh->Degree(v), v);
    }
    const std::size_t more = std::min(uncovered.size() - crowded.size(), least.size());
    std::partial_sort(least.begin(), least.begin() + static_cast<std::ptrdiff_t>(more),
                      least.end());
    for (std::size_t i = 0; i < more; ++i) crowded.push_back(least[i].second);
  }

  const std::vector<std::int32_t> room = relocation.FindRoom(16 * crowded.size() + 256);
  std::size_t next_room = 0;
  std::size_t next_place = 0;
  std::int64_t count = 0;
  std::int32_t slots[2];
  std::int64_t tried = 0;
  for (const std::int32_t v : crowded) {
    if (interrupt->RequestedAt(tried++)) break;
    if (next_place < uncovered.size()) {
      const UncoveredPlace& place = uncovered[next_place];
      const std::int32_t* corner = &mesh->origin[3 * place.triangle];
      const bool usable = corner[0] >= 0 && corner[0] != v && corner[1] != v && corner[2] != v &&
                          samples->component[corner[0]] == samples->component[v];
      if (usable) {
        ++next_place;
        if (!relocation.TakeOut(v, slots)) continue;
        relocation.PutIn(v, place.triangle, slots, AtVertex(surface, place.vertex));
        ++count;
        continue;
      }
    }
    while (next_room < room.size() && !relocation.HasRoom(room[next_room], samples->component[v])) {
      ++next_room;
    }
    if (next_room == room.size()) break;
    const std::int32_t t = room[next_room++];
    if (!relocation.TakeOut(v, slots)) continue;
    relocation.PutIn(v, t, slots, relocation.Center(t));
    ++count;
  }
  return count;
}

}  // namespace ccst
