#include "core/sampling/start/vertex_removal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "core/sampling/mesh/edge_flips.h"

namespace ccst::internal {
namespace {

/// What the worst new triangle must reach, from round to round; the last one takes anything.
constexpr std::array<double, 4> kDemands = {0.2, 0.02, -0.5,
                                            -std::numeric_limits<double>::infinity()};

/// Attempts at turning edges of each kind when nothing can be collapsed.
constexpr int kFlipRounds = 16;

/// Triangles whose quality is one unit of work of an Interrupt, and units that a vertex takes
/// besides.
constexpr std::int64_t kTrianglesAUnit = 16;
constexpr std::int64_t kVertexWork = 16;

/// Shape of triangle (a, b, c) times how well it faces `up`: 1 for an equilateral triangle in the
/// surface, 0 for a degenerate one, negative when turned over.
double SignedQuality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                     const Eigen::Vector3d& up) {
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const double edges = ab.squaredNorm() + ac.squaredNorm() + (c - b).squaredNorm();
  return edges > 0.0 ? 2.0 * std::numbers::sqrt3 * ab.cross(ac).dot(up) / edges : 0.0;
}

class Removal {
 public:
  Removal(const std::vector<Eigen::Vector3d>& position, const std::vector<Eigen::Vector3d>& normal,
          SampleMesh* mesh, Interrupt* interrupt)
      : position_(position),
        normal_(normal),
        mesh_(*mesh),
        interrupt_(*interrupt),
        flips_(mesh, &position, &normal) {}

  /// Collapses `v` when its best collapse reaches `demand`. @return the surviving neighbour or -1.
  std::int32_t TryRemove(std::int32_t v, double demand) {
    ring_.clear();
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) { ring_.push_back(h); });
    double best = -std::numeric_limits<double>::infinity();
    std::int32_t best_half_edge = -1;
    for (const std::int32_t h : ring_) {
      if (interrupt_.RequestedAfter(1 +
                                    static_cast<std::int64_t>(ring_.size()) / kTrianglesAUnit)) {
        return -1;
      }
      const double quality = WorstAfter(h, v, std::max(best, demand));
      if (quality < demand || (best_half_edge >= 0 && quality <= best)) continue;
      if (!mesh_.CanCollapse(h)) continue;
      best = quality;
      best_half_edge = h;
    }
    if (best_half_edge < 0) return -1;
    const std::int32_t w = mesh_.Target(best_half_edge);
    mesh_.Collapse(best_half_edge);
    flips_.touched.clear();
    flips_.FlipAround(w, &interrupt_);
    return w;
  }

  /// Turns an edge at `v` so that another collapse may become possible, or with `beyond` one
  /// across from a neighbour of three edges, which may not lose one.
  bool FlipAny(std::int32_t v, bool beyond) {
    std::int32_t candidate = -1;
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
      const std::int32_t u = mesh_.Target(h);
      if (!beyond || mesh_.IsBoundary(u) || mesh_.HasMoreEdges(u, 3)) return;
      mesh_.ForEachOutgoing(u, [&](std::int32_t e) {
        const std::int32_t side = SampleMesh::Next(e);
        if (mesh_.origin[side] != v && mesh_.Target(side) != v && mesh_.CanFlip(side)) {
          candidate = side;
        }
      });
    });
    mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
      if (candidate < 0 && mesh_.CanFlip(h)) candidate = h;
    });
    if (candidate < 0) return false;
    mesh_.Flip(candidate);
    return true;
  }

 private:
  /// Worst quality of the triangles that collapsing `h` would leave; gives up below `enough`.
  double WorstAfter(std::int32_t h, std::int32_t v, double enough) const {
    const std::int32_t w = mesh_.Target(h);
    double worst = std::numeric_limits<double>::max();
    for (const std::int32_t e : ring_) {
      if (mesh_.FallsWith(h, e)) continue;
      const std::int32_t b = mesh_.Target(e);
      const std::int32_t c = mesh_.Apex(e);
      const Eigen::Vector3d up = (normal_[v] + normal_[w] + normal_[b] + normal_[c]) * 0.25;
      worst = std::min(worst, SignedQuality(position_[w], position_[b], position_[c], up));
      if (worst < enough) break;
    }
    return worst;
  }

  const std::vector<Eigen::Vector3d>& position_;
  const std::vector<Eigen::Vector3d>& normal_;
  SampleMesh& mesh_;
  Interrupt& interrupt_;
  EdgeFlips flips_;
  std::vector<std::int32_t> ring_;
};

}  // namespace

absl::StatusOr<std::vector<std::int32_t>> RemoveVertices(
    std::int32_t keep, const std::vector<Eigen::Vector3d>& position,
    const std::vector<Eigen::Vector3d>& normal, Interrupt* interrupt, SampleMesh* mesh) {
  std::vector<std::int32_t> waiting;
  for (std::int32_t v = keep; v < mesh->vertex_count(); ++v) {
    if (mesh->outgoing[v] >= 0) waiting.push_back(v);
  }
  Removal removal(position, normal, mesh, interrupt);
  std::vector<std::int32_t> touched(mesh->vertex_count(), -1);
  std::vector<std::int32_t> later;
  std::size_t demand = 0;
  int flip_rounds = 0;
  for (int round = 0; !waiting.empty(); ++round) {
    later.clear();
    std::size_t removed = 0;
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < waiting.size(); ++i) {
      if (interrupt->RequestedAfter(kVertexWork)) {
        return interrupt->Error("the first triangulation was built");
      }
      const std::int32_t v = waiting[i];
      if (touched[v] == round) {
        ++skipped;
        later.push_back(v);
        continue;
      }
      const std::int32_t w = removal.TryRemove(v, kDemands[demand]);
      if (w < 0) {
        later.push_back(v);
        continue;
      }
      ++removed;
      touched[w] = round;
      mesh->ForEachOutgoing(w, [&](std::int32_t h) {
        touched[mesh->Target(h)] = round;
        touched[mesh->Apex(h)] = round;
      });
    }
    waiting.swap(later);
    if (20 * removed >= waiting.size() && removed > 0) continue;
    if (demand + 1 < kDemands.size()) {
      ++demand;
      continue;
    }
    if (removed > 0 || skipped > 0) continue;
    // Nothing can be collapsed as things stand; turn some edges and try again a few times.
    if (++flip_rounds > 2 * kFlipRounds) break;
    for (const std::int32_t v : waiting) {
      if (interrupt->RequestedAfter(kVertexWork)) break;
      removal.FlipAny(v, flip_rounds > kFlipRounds);
    }
  }
  return waiting;
}

}  // namespace ccst::internal
