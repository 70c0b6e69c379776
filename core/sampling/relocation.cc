#include "core/sampling/relocation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace ccst {
namespace {

/// Cosine of the largest angle between normals of samples on the same side (80 degrees).
const double kSameSide = std::cos(80.0 * std::numbers::pi / 180.0);

double TwiceArea(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  return (samples.position[b] - samples.position[a])
      .cross(samples.position[c] - samples.position[a])
      .norm();
}

/// Sum of the areas around `v`, twice.
double RingArea(const SampleMesh& mesh, const Samples& samples, std::int32_t v, int* triangles) {
  double area = 0.0;
  *triangles = 0;
  mesh.ForEachOutgoing(v, [&](std::int32_t h) {
    area += TwiceArea(samples, v, mesh.Target(h), mesh.Apex(h));
    ++*triangles;
  });
  return area;
}

/// Spacing of a regular triangulation with the mean triangle area around `v`.
double LocalSpacing(const SampleMesh& mesh, const Samples& samples, std::int32_t v) {
  int triangles = 0;
  const double area = RingArea(mesh, samples, v, &triangles);
  return std::sqrt(2.0 / std::sqrt(3.0) * area / triangles);
}

double SmallestCosineSlack(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  const Eigen::Vector3d ab = (samples.position[b] - samples.position[a]).normalized();
  const Eigen::Vector3d bc = (samples.position[c] - samples.position[b]).normalized();
  const Eigen::Vector3d ca = (samples.position[a] - samples.position[c]).normalized();
  return std::max({-ab.dot(ca), -bc.dot(ab), -ca.dot(bc)});
}

}  // namespace

std::vector<std::int32_t> FindDefects(const SampleMesh& mesh, const Samples& samples,
                                      const DefectLimits& limits) {
  std::vector<std::int32_t> found;
  const auto movable = [&](std::int32_t v) {
    return samples.kind[v] == SampleMesh::Kind::kInterior;
  };
  // Of several samples, the one with the least room.
  const auto blame = [&](std::initializer_list<std::int32_t> candidates) {
    std::int32_t worst = -1;
    double least = 0.0;
    for (const std::int32_t v : candidates) {
      if (!movable(v)) continue;
      int triangles = 0;
      const double area = RingArea(mesh, samples, v, &triangles);
      if (worst < 0 || area < least) {
        worst = v;
        least = area;
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
        (limits.least_angle > 0.0 && SmallestCosineSlack(samples, a, b, c) > cosine)) {
      blame({a, b, c});
    }
  }
  const auto crowded = [&](std::int32_t c, std::int32_t d) {
    if (c == d || samples.normal[c].dot(samples.normal[d]) < kSameSide) return;
    const double distance = (samples.position[c] - samples.position[d]).norm();
    const double spacing = std::min(LocalSpacing(mesh, samples, c), LocalSpacing(mesh, samples, d));
    if (distance < limits.least_separation * spacing) blame({c, d});
  };
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    const std::int32_t g = mesh.twin[h];
    if (g < h) continue;
    crowded(mesh.Apex(h), mesh.Apex(g));
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
  const std::size_t wanted = std::min(destinations.size(), 8 * crowded.size() + 64);
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
                                    (1.0 - SmallestCosineSlack(*samples, w, b, c)));
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
