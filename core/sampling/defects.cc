#include "core/sampling/defects.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "core/sampling/edge_flips.h"

namespace ccst {
namespace {

/// A sample whose total angle is this much below 2 pi holds a tip [rad].
constexpr double kTipDeficit = 1.3;

/// Triangles or samples that one thread looks at in one go.
constexpr std::int32_t kPiece = 8192;

double TwiceArea(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  return (samples.position[b] - samples.position[a])
      .cross(samples.position[c] - samples.position[a])
      .norm();
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

/// What FindDefects() looks at; only read, by several threads.
class DefectSearch {
 public:
  DefectSearch(const Surface& surface, const Density& density, const Plan& plan,
               const SampleMesh& mesh, const Samples& samples, const DefectLimits& limits,
               const DefectLimits& grave, const std::vector<std::uint8_t>& scope)
      : surface_(surface),
        density_(density),
        mesh_(mesh),
        samples_(samples),
        scope_(scope),
        limits_(limits),
        grave_(grave),
        cosine_(limits.least_angle > 0.0 ? std::cos(limits.least_angle) : 2.0),
        grave_cosine_(grave.least_angle > 0.0 ? std::cos(grave.least_angle) : 2.0),
        footprint_(0.5 * plan.spacing * plan.spacing) {
    squared_spacing_.reserve(plan.components.size());
    for (const ComponentPlan& component : plan.components) {
      squared_spacing_.push_back(4.0 / std::sqrt(3.0) * component.target);
    }
  }

  /// A triangle that is turned over or sharp.
  void CheckTriangle(std::int32_t t, std::vector<Defect>* found) const {
    const std::int32_t a = mesh_.origin[3 * t];
    const std::int32_t b = mesh_.origin[3 * t + 1];
    const std::int32_t c = mesh_.origin[3 * t + 2];
    if (!(scope_[a] | scope_[b] | scope_[c])) return;
    const double facing = Facing(samples_.position, samples_.normal, a, b, c);
    const double sharpest = cosine_ <= 1.0 ? SmallestAngleCosine(samples_, a, b, c) : 0.0;
    if (facing < limits_.least_facing || sharpest > cosine_) {
      Blame({a, b, c}, facing < grave_.least_facing || sharpest > grave_cosine_, found);
    }
  }

  /// A sample that crowds others, or whose valence its angle does not ask for.
  void CheckSample(std::int32_t v, std::vector<Defect>* found) const {
    if (!scope_[v] || samples_.kind[v] == SampleMesh::Kind::kPoint) return;
    int degree = mesh_.IsBoundary(v) ? 1 : 0;
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
      ++degree;
      if (limits_.all_near) {
        CheckNear(v, h, found);
      } else if (mesh_.twin[h] > h) {
        CheckPair(mesh_.Apex(h), mesh_.Apex(mesh_.twin[h]), found);
      }
    });
    if (!IsMovable(v) || (degree >= 5 && degree <= 7)) return;
    const double regular = TotalAngle(mesh_, samples_, v) * 3.0 / std::numbers::pi;
    if (std::abs(degree - regular) > limits_.most_excess) found->push_back({v, false});
  }

 private:
  bool IsMovable(std::int32_t v) const { return samples_.kind[v] == SampleMesh::Kind::kInterior; }

  bool HoldsTip(std::int32_t v) const {
    return TotalAngle(mesh_, samples_, v) < 2.0 * std::numbers::pi - kTipDeficit;
  }

  /// Of several samples, the one with the least room; one that holds a tip only for want of
  /// another.
  void Blame(std::initializer_list<std::int32_t> candidates, bool is_grave,
             std::vector<Defect>* found) const {
    std::int32_t worst = -1;
    std::pair<bool, double> least;
    for (const std::int32_t v : candidates) {
      if (!IsMovable(v)) continue;
      const std::pair<bool, double> room(HoldsTip(v), RingArea(mesh_, samples_, v));
      if (worst < 0 || room < least) {
        worst = v;
        least = room;
      }
    }
    if (worst >= 0) found->push_back({worst, is_grave});
  }

  /// Pairs of `v` with the target of `h`, the third corner of its triangle, and their neighbours.
  void CheckNear(std::int32_t v, std::int32_t h, std::vector<Defect>* found) const {
    // Every pair once, from its smaller index, or from the one in the scope.
    const auto check = [&](std::int32_t u) {
      if (u > v || (u < v && !scope_[u])) CheckPair(v, u, found);
    };
    const auto check_around = [&](std::int32_t u) {
      check(u);
      mesh_.ForEachOutgoing(u, [&](std::int32_t e) {
        check(mesh_.Target(e));
        if (mesh_.twin[SampleMesh::Previous(e)] < 0) check(mesh_.Apex(e));
      });
    };
    check_around(mesh_.Target(h));
    if (mesh_.twin[SampleMesh::Previous(h)] < 0) check_around(mesh_.Apex(h));
  }

  void CheckPair(std::int32_t c, std::int32_t d, std::vector<Defect>* found) const {
    double distance = (samples_.position[c] - samples_.position[d]).squaredNorm() /
                      squared_spacing_[samples_.component[c]];
    if (!density_.uniform()) {
      // Where it changes fast the denser of the two ends decides.
      distance *= std::max(density_.At(samples_.face[c], samples_.weights[c], footprint_),
                           density_.At(samples_.face[d], samples_.weights[d], footprint_));
    }
    if (distance < limits_.least_separation * limits_.least_separation &&
        FaceCross(surface_, samples_.face[c]).dot(FaceCross(surface_, samples_.face[d])) > 0.0) {
      Blame({c, d}, distance < grave_.least_separation * grave_.least_separation, found);
    }
  }

  const Surface& surface_;
  const Density& density_;
  const SampleMesh& mesh_;
  const Samples& samples_;
  const std::vector<std::uint8_t>& scope_;
  const DefectLimits limits_;
  const DefectLimits grave_;
  const double cosine_;
  const double grave_cosine_;
  const double footprint_;
  std::vector<double> squared_spacing_;  // Per component.
};

}  // namespace

void KeepOneEach(std::vector<Defect>* defects) {
  std::sort(defects->begin(), defects->end(), [](const Defect& a, const Defect& b) {
    return a.sample != b.sample ? a.sample < b.sample : a.grave > b.grave;
  });
  const auto same = [](const Defect& a, const Defect& b) { return a.sample == b.sample; };
  defects->erase(std::unique(defects->begin(), defects->end(), same), defects->end());
}

double RingArea(const SampleMesh& mesh, const Samples& samples, std::int32_t v) {
  double area = 0.0;
  mesh.ForEachOutgoing(
      v, [&](std::int32_t h) { area += TwiceArea(samples, v, mesh.Target(h), mesh.Apex(h)); });
  return area;
}

double SmallestAngleCosine(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  const Eigen::Vector3d ab = (samples.position[b] - samples.position[a]).normalized();
  const Eigen::Vector3d bc = (samples.position[c] - samples.position[b]).normalized();
  const Eigen::Vector3d ca = (samples.position[a] - samples.position[c]).normalized();
  return std::max({-ab.dot(ca), -bc.dot(ab), -ca.dot(bc)});
}

std::vector<Defect> FindDefects(const Surface& surface, const Density& density, const Plan& plan,
                                const SampleMesh& mesh, const Samples& samples,
                                const DefectLimits& limits, const DefectLimits& grave,
                                const std::vector<std::uint8_t>& scope, const Parallel& parallel,
                                Interrupt* interrupt) {
  const DefectSearch search(surface, density, plan, mesh, samples, limits, grave, scope);
  const std::int32_t most = std::max(mesh.triangle_count(), mesh.vertex_count());
  std::vector<std::vector<Defect>> pieces((most + kPiece - 1) / kPiece);
  parallel.For(static_cast<std::int64_t>(pieces.size()), [&, stop = *interrupt](std::int64_t p) {
    if (Interrupt(stop).Requested()) return;
    std::vector<Defect>& found = pieces[static_cast<std::size_t>(p)];
    const auto first = static_cast<std::int32_t>(p) * kPiece;
    const std::int32_t end = first + std::min(kPiece, most - first);
    for (std::int32_t t = first; t < std::min(end, mesh.triangle_count()); ++t) {
      search.CheckTriangle(t, &found);
    }
    for (std::int32_t v = first; v < std::min(end, mesh.vertex_count()); ++v) {
      search.CheckSample(v, &found);
    }
  });
  std::vector<Defect> found;
  for (const std::vector<Defect>& piece : pieces) {
    found.insert(found.end(), piece.begin(), piece.end());
  }
  KeepOneEach(&found);
  return found;
}

}  // namespace ccst
