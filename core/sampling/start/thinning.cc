#include "core/sampling/start/thinning.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "core/sampling/mesh/edge_flips.h"

namespace ccst::internal {
namespace {

/// What the worst new triangle must reach, see ShapeAfter.
constexpr float kDemand = 0.2F;
/// A vertex with more edges has them flipped before it is looked at.
constexpr int kManyEdges = 8;
/// Units of work, for an Interrupt, of looking at a vertex, whose neighbours may have many edges.
constexpr std::int64_t kVertexWork = 32;
/// Vertices whose blocks one thread compares in one go.
constexpr std::int64_t kPiece = 8192;

/// The triangles around a vertex, for as many lanes as registers have; places are relative to it.
struct Fan {
  static constexpr int kMost = 32;
  static constexpr int kLanes = 8;

  using Row = std::array<float, kMost + 1>;
  struct Rows {
    Row x, y, z;
  };

  int count = 0;  // Of neighbours, and of triangles: number i lies between neighbours i and i + 1.
  std::array<std::int32_t, kMost> half_edge;
  std::array<std::int32_t, kMost> vertex;
  Rows place;
  Rows normal;
  Row length;  // Squared, of the spokes.
  // Of triangles: the sides across and what does not depend on where the vertex goes.
  Rows across;
  Rows cross;
  Rows middle;
  Rows up;
  Row lengths;
};

/// Everything in one block. Reads and writes nothing that another block writes: only vertices all
/// of whose neighbours lie in the block are merged, or lose or gain an edge by a flip of one of
/// theirs, so only triangles in the block change.
class BlockThinning {
 public:
  BlockThinning(const std::vector<Eigen::Vector3d>& position,
                const std::vector<Eigen::Vector3d>& normal, const std::vector<std::uint8_t>& inside,
                std::vector<std::int32_t>* touched, SampleMesh* mesh)
      : position_(position), normal_(normal), inside_(inside), touched_(*touched), mesh_(*mesh) {}

  /// Rounds over vertices whose rings are disjoint, until one removes few.
  void Run(std::vector<std::int32_t> waiting, Interrupt* interrupt) {
    std::vector<std::int32_t> later;
    for (int round = 0; !waiting.empty(); ++round) {
      later.clear();
      std::size_t removed = 0;
      if (interrupt->Requested()) return;
      for (std::size_t i = 0; i < waiting.size(); ++i) {
        if (interrupt->RequestedAfter(kVertexWork)) return;
        const std::int32_t v = waiting[i];
        const std::int32_t w = touched_[v] == round ? -1 : TryRemove(v);
        if (w < 0) {
          later.push_back(v);
          continue;
        }
        ++removed;
        touched_[w] = round;
        mesh_.ForEachOutgoing(w, [&](std::int32_t h) { touched_[mesh_.Target(h)] = round; });
      }
      waiting.swap(later);
      if (20 * removed < waiting.size()) return;
    }
  }

 private:
  /// Merges `v` into the neighbour that leaves the best triangles. @return that one, or -1 when
  /// none does well.
  std::int32_t TryRemove(std::int32_t v) {
    if (!Gather(v) || fan_.count > kManyEdges) {
      // Among samples that are denser than vertices; no neighbour can see all of the others.
      mesh_.ForEachOutgoing(v, [&](std::int32_t h) { stack_.push_back(h); });
      Flip();
      if (!Gather(v)) return -1;
    }
    std::array<float, Fan::kMost> quality;
    for (int j = 0; j < fan_.count; ++j) {
      quality[j] = inside_[fan_.vertex[j]] != 0 ? ShapeAfter(j) : -1.0F;
    }
    while (true) {
      const auto* best = std::max_element(quality.data(), quality.data() + fan_.count);
      if (!(*best >= kDemand)) return -1;
      const auto j = static_cast<int>(best - quality.data());
      if (CanCollapse(j)) return Collapse(j);
      quality[j] = -1.0F;
    }
  }

  /// @return false when there are too many neighbours.
  bool Gather(std::int32_t v) {
    int n = 0;
    const std::int32_t start = mesh_.outgoing[v];
    std::int32_t h = start;
    do {
      if (n == Fan::kMost) return false;
      fan_.half_edge[n] = h;
      fan_.vertex[n++] = mesh_.Target(h);
      h = mesh_.Rotate(h);
    } while (h != start);
    fan_.count = n;
    const Eigen::Vector3d& center = position_[v];
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3d place = position_[fan_.vertex[i]] - center;
      const Eigen::Vector3d& normal = normal_[fan_.vertex[i]];
      Put(place, i, &fan_.place);
      Put(normal, i, &fan_.normal);
      fan_.length[i] = fan_.place.x[i] * fan_.place.x[i] + fan_.place.y[i] * fan_.place.y[i] +
                       fan_.place.z[i] * fan_.place.z[i];
    }
    // Lanes beyond the last repeat the first.
    const int lanes = (n + Fan::kLanes - 1) / Fan::kLanes * Fan::kLanes;
    for (int i = n; i <= lanes; ++i) {
      for (Fan::Rows* rows : {&fan_.place, &fan_.normal}) {
        rows->x[i] = rows->x[0];
        rows->y[i] = rows->y[0];
        rows->z[i] = rows->z[0];
      }
      fan_.length[i] = fan_.length[0];
    }
    const Eigen::Vector3f up = normal_[v].cast<float>();
    const Fan::Rows& p = fan_.place;
    const Fan::Rows& m = fan_.normal;
    for (int first = 0; first < lanes; first += Fan::kLanes) {
      for (int i = first; i < first + Fan::kLanes; ++i) {
        const float dx = p.x[i + 1] - p.x[i];
        const float dy = p.y[i + 1] - p.y[i];
        const float dz = p.z[i + 1] - p.z[i];
        fan_.across.x[i] = dx;
        fan_.across.y[i] = dy;
        fan_.across.z[i] = dz;
        fan_.cross.x[i] = p.y[i] * p.z[i + 1] - p.z[i] * p.y[i + 1];
        fan_.cross.y[i] = p.z[i] * p.x[i + 1] - p.x[i] * p.z[i + 1];
        fan_.cross.z[i] = p.x[i] * p.y[i + 1] - p.y[i] * p.x[i + 1];
        fan_.middle.x[i] = p.x[i] + p.x[i + 1];
        fan_.middle.y[i] = p.y[i] + p.y[i + 1];
        fan_.middle.z[i] = p.z[i] + p.z[i + 1];
        fan_.up.x[i] = up[0] + m.x[i] + m.x[i + 1];
        fan_.up.y[i] = up[1] + m.y[i] + m.y[i + 1];
        fan_.up.z[i] = up[2] + m.z[i] + m.z[i + 1];
        fan_.lengths[i] = fan_.length[i] + fan_.length[i + 1] + (dx * dx + dy * dy + dz * dz);
      }
    }
    return true;
  }

  static void Put(const Eigen::Vector3d& value, int i, Fan::Rows* rows) {
    rows->x[i] = static_cast<float>(value[0]);
    rows->y[i] = static_cast<float>(value[1]);
    rows->z[i] = static_cast<float>(value[2]);
  }

  /// Shape of the worst triangle when the vertex goes to neighbour `j`, times how well it faces the
  /// surface: 1 for an equilateral triangle in the surface, 0 for a degenerate one, negative when
  /// turned over.
  float ShapeAfter(int j) const {
    const float x = fan_.place.x[j];
    const float y = fan_.place.y[j];
    const float z = fan_.place.z[j];
    const float nx = fan_.normal.x[j];
    const float ny = fan_.normal.y[j];
    const float nz = fan_.normal.z[j];
    const float twice = 2.0F * fan_.length[j];
    std::array<float, Fan::kMost> shape;
    for (int first = 0; first < fan_.count; first += Fan::kLanes) {
      for (int i = first; i < first + Fan::kLanes; ++i) {
        const float cx = fan_.cross.x[i] - (y * fan_.across.z[i] - z * fan_.across.y[i]);
        const float cy = fan_.cross.y[i] - (z * fan_.across.x[i] - x * fan_.across.z[i]);
        const float cz = fan_.cross.z[i] - (x * fan_.across.y[i] - y * fan_.across.x[i]);
        const float facing =
            cx * (fan_.up.x[i] + nx) + cy * (fan_.up.y[i] + ny) + cz * (fan_.up.z[i] + nz);
        const float sides =
            fan_.lengths[i] + twice -
            2.0F * (x * fan_.middle.x[i] + y * fan_.middle.y[i] + z * fan_.middle.z[i]);
        shape[i] = facing / (sides + 1e-30F);
      }
    }
    float worst = 1e30F;
    for (int i = 0; i < fan_.count; ++i) {
      // The two triangles at the edge to `j` go.
      if (i != j && i + 1 != j && (i + 1 != fan_.count || j != 0))
        worst = std::min(worst, shape[i]);
    }
    return 0.5F * std::numbers::sqrt3_v<float> * worst;
  }

  /// The link condition, and no vertex is left with fewer than three edges, none on the boundary
  /// with fewer than four triangles: stricter than SampleMesh::CanCollapse() there, and with less
  /// to look at, for all around lies off the boundary and is not locked.
  bool CanCollapse(int j) const {
    const std::int32_t h = fan_.half_edge[j];
    if (!KeepsThreeEdges(mesh_.Apex(h)) || !KeepsThreeEdges(mesh_.Apex(mesh_.twin[h]))) {
      return false;
    }
    return mesh_.CountNeighbours(fan_.vertex[j],
                                 {fan_.vertex.data(), static_cast<std::size_t>(fan_.count)}) == 2;
  }

  /// Whether there are more than three triangles at `u`, so that one may go.
  bool KeepsThreeEdges(std::int32_t u) const {
    const std::int32_t start = mesh_.outgoing[u];
    std::int32_t h = start;
    for (int i = 0; i < 3; ++i) {
      h = mesh_.Rotate(h);
      if (h < 0 || h == start) return false;
    }
    return true;
  }

  std::int32_t Collapse(int j) {
    const std::int32_t w = fan_.vertex[j];
    mesh_.Collapse(fan_.half_edge[j]);
    // The edges of what is left of the fan.
    for (int step = 1; step + 1 < fan_.count; ++step) {
      const std::int32_t h = fan_.half_edge[(j + step) % fan_.count];
      stack_.push_back(h);
      stack_.push_back(SampleMesh::Next(h));
      if (step + 2 == fan_.count) stack_.push_back(SampleMesh::Previous(h));
    }
    Flip();
    return w;
  }

  void Flip() {
    // The area falls with every flip; the bound only guards against rounding.
    for (int flips = 0; !stack_.empty() && flips < 1000;) {
      const std::int32_t h = stack_.back();
      stack_.pop_back();
      const std::int32_t g = mesh_.twin[h];
      if (g < 0 || !IsWanted(h, g) || !mesh_.CanFlip(h)) continue;
      mesh_.Flip(h);
      ++flips;
      for (const std::int32_t e : {SampleMesh::Next(h), SampleMesh::Previous(h),
                                   SampleMesh::Next(g), SampleMesh::Previous(g)}) {
        stack_.push_back(e);
      }
    }
    stack_.clear();
  }

  /// As EdgeFlips has it, for edges inside the block.
  bool IsWanted(std::int32_t h, std::int32_t g) const {
    const std::int32_t a = mesh_.origin[h];
    const std::int32_t b = mesh_.origin[g];
    if ((inside_[a] & inside_[b]) == 0) return false;
    return FlipImproves(position_, normal_, a, b, mesh_.Apex(h), mesh_.Apex(g));
  }

  const std::vector<Eigen::Vector3d>& position_;
  const std::vector<Eigen::Vector3d>& normal_;
  const std::vector<std::uint8_t>& inside_;
  std::vector<std::int32_t>& touched_;  // Per vertex: the last round that changed its ring.
  SampleMesh& mesh_;
  Fan fan_;
  std::vector<std::int32_t> stack_;
};

/// Per vertex: whether it and all its neighbours are of one block, and none of its edges is one of
/// the boundary or locked.
std::vector<std::uint8_t> FindInside(const std::vector<std::int32_t>& block,
                                     const Parallel& parallel, const SampleMesh& mesh) {
  std::vector<std::uint8_t> inside(mesh.vertex_count(), 1);
  // Several threads may find the same.
  const auto mark = [&](std::int32_t v) {
    std::atomic_ref<std::uint8_t>(inside[v]).store(0, std::memory_order_relaxed);
  };
  parallel.ForRanges(mesh.triangle_count(), kPiece, [&](std::int64_t first, std::int64_t end) {
    for (auto t = static_cast<std::int32_t>(first); t < static_cast<std::int32_t>(end); ++t) {
      if (mesh.IsDead(TriangleIndex(t))) continue;
      for (std::int32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::int32_t from = mesh.origin[h];
        const std::int32_t to = mesh.Target(h);
        if (block[from] == block[to] && mesh.twin[h] >= 0 && !mesh.IsLocked(h)) continue;
        mark(from);
        mark(to);
      }
    }
  });
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.outgoing[v] < 0) inside[v] = 0;
  }
  return inside;
}

}  // namespace

void ThinBlocks(std::int32_t keep, const std::vector<std::int32_t>& block,
                const std::vector<Eigen::Vector3d>& position,
                const std::vector<Eigen::Vector3d>& normal, const Parallel& parallel,
                Interrupt* interrupt, SampleMesh* mesh) {
  const std::vector<std::uint8_t> inside = FindInside(block, parallel, *mesh);
  std::vector<std::vector<std::int32_t>> waiting;
  for (std::int32_t v = keep; v < mesh->vertex_count(); ++v) {
    if (inside[v] == 0) continue;
    const auto b = static_cast<std::size_t>(block[v]);
    if (b >= waiting.size()) waiting.resize(b + 1);
    waiting[b].push_back(v);
  }
  std::vector<std::int32_t> touched(mesh->vertex_count(), -1);
  parallel.For(static_cast<std::int64_t>(waiting.size()), [&, stop = *interrupt](std::int64_t b) {
    Interrupt own = stop;
    BlockThinning(position, normal, inside, &touched, mesh)
        .Run(std::move(waiting[static_cast<std::size_t>(b)]), &own);
  });
}

}  // namespace ccst::internal
