#include "core/sampling/relax/defects.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/portable_math.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/surface/frame.h"

namespace ccst::internal {
namespace {

/// A sample whose total angle is this much below 2 pi holds a tip [rad].
constexpr double kTipDeficit = 1.3;

/// Triangles or samples that one thread looks at in one go.
constexpr std::int32_t kPiece = 8192;

/// Pairs of samples that are one unit of work of an Interrupt.
constexpr std::int64_t kPairsAUnit = 64;

double TwiceArea(const Samples& samples, std::int32_t a, std::int32_t b, std::int32_t c) {
  return (samples.position[b] - samples.position[a])
      .cross(samples.position[c] - samples.position[a])
      .norm();
}

/// Sum of the angles at `v`; 2 pi where the sample mesh is flat.
double TotalAngle(const SampleMesh& mesh, const Samples& samples, std::int32_t v) {
  double sum = 0.0;
  mesh.ForEachOutgoing(v, [&](std::int32_t h) {
    sum += AngleBetween(samples.position[mesh.Target(h)] - samples.position[v],
                        samples.position[mesh.Apex(h)] - samples.position[v]);
  });
  return sum;
}

/// What decides whether two are too near.
struct Sample {
  std::int32_t vertex;
  Eigen::Vector3d position;
  double density;
};

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
        cosine_(limits.least_angle > 0.0 ? PortableCos(limits.least_angle) : 2.0),
        grave_cosine_(grave.least_angle > 0.0 ? PortableCos(grave.least_angle) : 2.0),
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
      if (!limits_.all_near && mesh_.twin[h] > h) {
        CheckPair(SampleAt(mesh_.Apex(h)), SampleAt(mesh_.Apex(mesh_.twin[h])), found);
      }
    });
    if (!IsMovable(v) || (degree >= 5 && degree <= 7)) return;
    const double regular = TotalAngle(mesh_, samples_, v) * 3.0 / std::numbers::pi;
    if (std::abs(degree - regular) > limits_.most_excess) found->push_back({v, false});
  }

  /// Marks `v` and its neighbours if it is in the scope: pairs that are two edges apart are looked
  /// for at what is between them.
  void MarkMiddles(std::int32_t v, std::vector<std::uint8_t>* is_middle) const {
    if (!scope_[v] || samples_.kind[v] == SampleMesh::Kind::kPoint) return;
    // Several threads may mark one.
    const auto mark = [&](std::int32_t u) {
      std::atomic_ref<std::uint8_t>((*is_middle)[u]).store(1, std::memory_order_relaxed);
    };
    mark(v);
    mesh_.ForEachNeighbour(v, mark);
  }

  /// Pairs of `v` with a neighbour, and of two of its neighbours: all up to two edges apart are
  /// among them.
  /// @param ring  room to work in.
  void CheckAround(std::int32_t v, std::vector<Sample>* ring, std::vector<Defect>* found) const {
    const Sample middle = SampleAt(v);
    ring->clear();
    mesh_.ForEachNeighbour(v, [&](std::int32_t u) { ring->push_back(SampleAt(u)); });
    for (std::size_t i = 0; i < ring->size(); ++i) {
      const Sample& one = (*ring)[i];
      if (v < one.vertex) CheckPair(middle, one, found);
      // The next one is its neighbour, and they are a pair there.
      for (std::size_t j = i + 2; j < ring->size(); ++j) CheckPair(one, (*ring)[j], found);
    }
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

  Sample SampleAt(std::int32_t v) const {
    return {
        v, samples_.position[v],
        density_.uniform() ? 1.0 : density_.At(samples_.face[v], samples_.weights[v], footprint_)};
  }

  void CheckPair(const Sample& c, const Sample& d, std::vector<Defect>* found) const {
    // Where the density changes fast the denser of the two ends decides.
    const double distance =
        (c.position - d.position).squaredNorm() * std::max(c.density, d.density);
    const double unit = squared_spacing_[samples_.component[c.vertex]];
    if (distance < limits_.least_separation * limits_.least_separation * unit &&
        (scope_[c.vertex] | scope_[d.vertex]) != 0 &&
        surface_.FaceCross(samples_.face[c.vertex])
                .dot(surface_.FaceCross(samples_.face[d.vertex])) > 0.0) {
      Blame({c.vertex, d.vertex},
            distance < grave_.least_separation * grave_.least_separation * unit, found);
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
  std::vector<std::uint8_t> is_middle;
  if (limits.all_near) {
    is_middle.assign(static_cast<std::size_t>(mesh.vertex_count()), 0);
    parallel.ForRanges(mesh.vertex_count(), kPiece, [&](std::int64_t first, std::int64_t end) {
      for (std::int64_t v = first; v < end; ++v) {
        search.MarkMiddles(static_cast<std::int32_t>(v), &is_middle);
      }
    });
  }
  std::vector<std::vector<Defect>> pieces((most + kPiece - 1) / kPiece);
  parallel.For(static_cast<std::int64_t>(pieces.size()), [&, stop = *interrupt](std::int64_t p) {
    Interrupt own = stop;
    std::vector<Defect>& found = pieces[static_cast<std::size_t>(p)];
    const auto first = static_cast<std::int32_t>(p) * kPiece;
    const std::int32_t end = first + std::min(kPiece, most - first);
    for (std::int32_t t = first; t < std::min(end, mesh.triangle_count()); ++t) {
      if (own.RequestedAt(t)) return;
      search.CheckTriangle(t, &found);
    }
    std::vector<Sample> ring;
    for (std::int32_t v = first; v < std::min(end, mesh.vertex_count()); ++v) {
      if (own.RequestedAfter(1)) return;
      search.CheckSample(v, &found);
      if (is_middle.empty() || is_middle[v] == 0) continue;
      search.CheckAround(v, &ring, &found);
      const auto pairs = static_cast<std::int64_t>(ring.size() * ring.size());
      if (own.RequestedAfter(pairs / kPairsAUnit)) return;
    }
  });
  std::vector<Defect> found;
  for (const std::vector<Defect>& piece : pieces) {
    found.insert(found.end(), piece.begin(), piece.end());
  }
  KeepOneEach(&found);
  return found;
}

}  // namespace ccst::internal
