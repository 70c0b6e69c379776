#include "core/sampling/relocation.h"

#include <algorithm>
#include <cmath>
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

std::vector<std::int32_t> FindDefects(const Surface& surface, const Plan& plan,
                                      const SampleMesh& mesh, const Samples& samples,
                                      const DefectLimits& limits) {
  std::vector<std::int32_t> found;
  const auto movable = [&](std::int32_t v) {
    return samples.kind[v] == SampleMesh::Kind::kInterior;
  };
  const auto holds_tip = [&](std::int32_t v) {
    return TotalAngle(mesh, samples, v) < 2.0 * std::numbers::pi - kTipDeficit;
  };
  // Of several samples, the one with the least room; one that holds a tip only for want of another.
  const auto blame = [&](std::initializer_list<std::int32_t> candidates) {
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
    if (worst >= 0) found.push_back(worst);
  };
  const double cosine = std::cos(limits.least_angle);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::int32_t a = mesh.origin[3 * t];
    const std::int32_t b = mesh.origin[3 * t + 1];
    const std::int32_t c = mesh.origin[3 * t + 2];
    if (Facing(samples.position, samples.normal, a, b, c) < limits.least_facing ||
        (limits.least_angle > 0.0 && SmallestAngleCosine(samples, a, b, c) > cosine)) {
      blame({a, b, c});
    }
  }
  std::vector<double> separation;  // Per component, squared.
  for (const ComponentPlan& component : plan.components) {
    const double spacing = std::sqrt(4.0 / std::sqrt(3.0) * component.target);
    separation.push_back(std::pow(limits.least_separation * spacing, 2));
  }
  const auto check_pair = [&](std::int32_t c, std::int32_t d) {
    if ((samples.position[c] - samples.position[d]).squaredNorm() <
            separation[samples.component[c]] &&
        FaceCross(surface, samples.face[c]).dot(FaceCross(surface, samples.face[d])) > 0.0) {
      blame({c, d});
    }
  };
  if (limits.reach == 0) {
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
      if (mesh.twin[h] > h) check_pair(mesh.Apex(h), mesh.Apex(mesh.twin[h]));
    }
  } else {
    Neighbourhood near(mesh);
    for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
      for (const std::int32_t u : near.Of(v, limits.reach)) {
        if (u > v) check_pair(v, u);
      }
    }
  }
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!movable(v)) continue;
    const std::int32_t degree = mesh.Degree(v);
    if (degree >= 5 && degree <= 7) continue;
    const double regular = TotalAngle(mesh, samples, v) * 3.0 / std::numbers::pi;
    if (std::abs(degree - regular) > limits.most_excess) found.push_back(v);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::int64_t Relocate(const std::vector<std::int32_t>& crowded, const Surface& surface,
                      GeometryPhase* geometry, EdgeFlips* flips, SampleMesh* mesh,
                      Samples* samples) {
  if (crowded.empty()) return 0;
  // Samples near a change of this call stay out of further ones: their rings are not settled.
  std::vector<std::uint8_t> busy(samples->count(), 0);
  const auto reserve = [&](std::int32_t v) {
    busy[v] = 1;
    mesh->ForEachOutgoing(v, [&](std::int32_t h) {
      busy[mesh->Target(h)] = 1;
      busy[mesh->Apex(h)] = 1;
    });
  };
  for (const std::int32_t v : crowded) reserve(v);

  // Destinations by capacity, largest first; ties by index. A few spares for those that are busy.
  std::vector<std::pair<double, std::int32_t>> destinations;
  for (std::int32_t t = 0; t < mesh->triangle_count(); ++t) {
    destinations.emplace_back(-geometry->Capacity(t), t);
  }
  const std::size_t wanted = std::min(destinations.size(), 16 * crowded.size() + 256);
  std::partial_sort(destinations.begin(), destinations.begin() + wanted, destinations.end());
  destinations.resize(wanted);

  std::int64_t count = 0;
  std::size_t next = 0;
  std::vector<std::int32_t> ring;
  for (const std::int32_t v : crowded) {
    std::int32_t destination = -1;
    while (next < destinations.size() && destination < 0) {
      const std::int32_t t = destinations[next++].second;
      const auto corner = [&](int k) { return mesh->origin[3 * t + k]; };
      if (corner(0) < 0 || busy[corner(0)] || busy[corner(1)] || busy[corner(2)]) continue;
      if (samples->component[corner(0)] != samples->component[v]) continue;
      // A large triangle at a boundary, a tip or a crease may have no room for another sample.
      if (Facing(samples->position, samples->normal, corner(0), corner(1), corner(2)) < 0.9 ||
          samples->kind[corner(0)] != SampleMesh::Kind::kInterior ||
          samples->kind[corner(1)] != SampleMesh::Kind::kInterior ||
          samples->kind[corner(2)] != SampleMesh::Kind::kInterior) {
        continue;
      }
      destination = t;
    }
    if (destination < 0) break;

    // Out: into the neighbour that leaves the best-facing, roundest triangles.
    ring.clear();
    mesh->ForEachOutgoing(v, [&](std::int32_t h) { ring.push_back(h); });
    double best = -2.0;
    std::int32_t chosen = -1;
    for (const std::int32_t h : ring) {
      const std::int32_t w = mesh->Target(h);
      const std::int32_t g = mesh->twin[h];
      double worst = 2.0;
      for (const std::int32_t e : ring) {
        if (e == h || (g >= 0 && e == SampleMesh::Next(g))) continue;
        const std::int32_t b = mesh->Target(e);
        const std::int32_t c = mesh->Apex(e);
        worst = std::min(worst, Facing(samples->position, samples->normal, w, b, c) *
                                    (1.0 - SmallestAngleCosine(*samples, w, b, c)));
      }
      if (worst > best && mesh->CanCollapse(h)) {
        best = worst;
        chosen = h;
      }
    }
    if (chosen < 0) continue;
    const std::int32_t w = mesh->Target(chosen);
    const std::int32_t slot1 = chosen / 3;
    const std::int32_t slot2 = mesh->twin[chosen] / 3;
    mesh->Collapse(chosen);
    flips->FlipAround(w);
    reserve(w);
    geometry->Activate(w);

    // In: at the centre of the destination.
    const std::int32_t a = mesh->origin[3 * destination];
    const std::int32_t b = mesh->origin[3 * destination + 1];
    const std::int32_t c = mesh->origin[3 * destination + 2];
    const Eigen::Vector3d center =
        (samples->position[a] + samples->position[b] + samples->position[c]) / 3.0;
    SurfacePoint point = surface.Follow(samples->face[a], center);
    for (const std::int32_t corner : {b, c}) {
      const SurfacePoint other = surface.Follow(samples->face[corner], center);
      if ((other.position - center).squaredNorm() < (point.position - center).squaredNorm()) {
        point = other;
      }
    }
    samples->Place(v, surface, point);
    mesh->InsertIntoTriangle(v, destination, slot1, slot2);
    reserve(v);
    flips->FlipAround(v);
    geometry->Activate(v);
    ++count;
  }
  return count;
}

}  // namespace ccst
