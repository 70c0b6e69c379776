#include "core/sampling/start/insertion.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "core/sampling/start/face_triangulation.h"

namespace ccst::internal {
namespace {

/// Faces with samples that one thread triangulates in one go.
constexpr std::int64_t kPiece = 256;
/// Up to so many triangles of a face its vertices are looked up one by one.
constexpr std::size_t kFewTriangles = 16;
/// Steps and flips of an insertion that make one unit of work of an Interrupt.
constexpr std::int64_t kStepsAUnit = 64;

class Insertion {
 public:
  Insertion(const Surface& surface, const Plan& plan, const Samples& samples)
      : surface_(surface), plan_(plan), samples_(samples) {
    positions_ = samples.position;
    normals_ = samples.normal;
    positions_.insert(positions_.end(), surface.positions().begin(), surface.positions().end());
    normals_.insert(normals_.end(), surface.normals().begin(), surface.normals().end());
    vertex_of_.resize(surface.vertex_count());
    std::iota(vertex_of_.begin(), vertex_of_.end(), samples.count());
    components_ = samples.component;
    components_.reserve(positions_.size());
    for (const std::int32_t h : surface.outgoing()) {
      components_.push_back(surface.face_components()[h / 3]);
    }
  }

  void Run(const Parallel& parallel, Interrupt* interrupt) {
    AdoptCorners();
    if (interrupt->Requested()) return;
    SetTriangles();
    if (interrupt->Requested()) return;
    InsertBoundarySamples(interrupt);
    if (interrupt->Requested()) return;
    InsertInteriorSamples(parallel, interrupt);
  }

  InsertedSamples Take() && {
    return {std::move(mesh_), std::move(positions_), std::move(normals_), std::move(components_)};
  }

 private:
  /// A face with samples in it.
  struct Host {
    std::int32_t face = -1;
    std::size_t first = 0;  // Of its samples, in interior_.
    std::size_t end = 0;
  };

  /// An edge of a host's outline.
  struct OutlineEdge {
    std::int32_t before = -1;  // Its half-edge before samples were inserted.
    std::int32_t across = -1;  // And the one across from that.
    std::int32_t face = -1;
  };

  /// What one thread needs for one face after the other.
  struct Scratch {
    FaceTriangulation triangulation;
    std::vector<std::int32_t> triangles;  // Of the face, in the work mesh.
    std::vector<std::int32_t> vertices;
    std::unordered_map<std::int32_t, std::int32_t> number;  // Work vertex -> index in `vertices`.
    std::vector<Eigen::Vector3d> place;
    std::vector<Eigen::Vector3i> corners;
    std::vector<OutlineEdge> outline;  // By the vertex at which the edge starts.
    std::vector<std::uint8_t> is_locked;
  };

  /// A boundary sample that lies on a vertex of the surface takes its place.
  void AdoptCorners() {
    adopted_.assign(samples_.count(), 0);
    for (std::int32_t i = 0; i < samples_.count(); ++i) {
      if (samples_.loop[i] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        if (samples_.weights[i][k] < 1.0) continue;
        std::int32_t& vertex = vertex_of_[surface_.faces()[samples_.face[i]][k]];
        if (vertex < samples_.count()) continue;
        vertex = i;
        adopted_[i] = 1;
      }
    }
  }

  /// The faces, but of components that get points, and the fans of closed loops.
  void SetTriangles() {
    mesh_.twin = surface_.twins();
    mesh_.origin.resize(mesh_.twin.size());
    for (std::int32_t f = 0; f < surface_.face_count(); ++f) {
      const bool dead = plan_.components[surface_.face_components()[f]].points;
      for (int k = 0; k < 3; ++k) {
        mesh_.origin[3 * f + k] = dead ? -1 : vertex_of_[surface_.faces()[f][k]];
        if (dead) mesh_.twin[3 * f + k] = -1;
      }
    }
    std::size_t centers = 0;
    for (const LoopPlan& loop : plan_.loops) centers += loop.closed ? 1 : 0;
    mesh_.outgoing.assign(positions_.size() + centers, -1);
    for (std::int32_t v = 0; v < surface_.vertex_count(); ++v) {
      const std::int32_t h = surface_.outgoing()[v];
      if (mesh_.origin[h] >= 0) mesh_.outgoing[vertex_of_[v]] = h;
    }
    for (const LoopPlan& loop : plan_.loops) {
      if (loop.closed) CloseLoop(loop);
    }
    for (const LoopPlan& loop : plan_.loops) {
      if (!loop.crease || plan_.components[loop.component].points) continue;
      for (const std::int32_t h : loop.half_edges) mesh_.Lock(h);
    }
  }

  void CloseLoop(const LoopPlan& loop) {
    const auto center = static_cast<std::int32_t>(positions_.size());
    const auto first = static_cast<std::int32_t>(mesh_.origin.size());
    const auto end = first + 3 * static_cast<std::int32_t>(loop.half_edges.size());
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const std::int32_t h : loop.half_edges) {
      position += surface_.positions()[surface_.Origin(h)];
      normal += surface_.normals()[surface_.Origin(h)];
      // The fan goes on where the next edge of the loop starts.
      const auto side = static_cast<std::int32_t>(mesh_.origin.size());
      mesh_.origin.insert(mesh_.origin.end(),
                          {vertex_of_[surface_.Target(h)], vertex_of_[surface_.Origin(h)], center});
      mesh_.twin.insert(mesh_.twin.end(), {h, side == first ? end - 1 : side - 1,
                                           side + 3 == end ? first + 1 : side + 4});
      mesh_.twin[h] = side;
    }
    mesh_.outgoing[center] = first + 2;
    positions_.push_back(position / static_cast<double>(loop.half_edges.size()));
    normals_.push_back(normal.normalized());
    components_.push_back(loop.component);
  }

  /// The face of the surface in which triangle `t` lies.
  std::int32_t FaceOf(TriangleIndex t) const {
    return t < first_cut_ ? t : cut_[static_cast<std::size_t>(t - first_cut_)];
  }

  TriangleIndex NewTriangle(std::int32_t face) {
    cut_.push_back(face);
    return mesh_.NewTriangle();
  }

  void InsertBoundarySamples(Interrupt* interrupt) {
    first_cut_ = mesh_.triangle_count();
    // Samples of one loop come in the order of their arcs; the half-edge that remains ahead of
    // the last one inserted on an edge takes the next one.
    std::int32_t last_half_edge = -1;
    std::int32_t ahead = -1;
    std::int32_t last_loop = -1;
    for (std::int32_t i = 0; i < samples_.count(); ++i) {
      if (interrupt->RequestedAt(i)) return;
      const std::int32_t l = samples_.loop[i];
      if (l < 0 || adopted_[i]) continue;
      const LoopPlan& loop = plan_.loops[l];
      const std::int32_t h = loop.half_edges[loop.Segment(samples_.arc[i])];
      if (l != last_loop || h != last_half_edge) {
        ahead = mesh_.FindEdge(vertex_of_[surface_.Origin(h)], vertex_of_[surface_.Target(h)]);
      }
      if (loop.crease) {
        const TriangleIndex slot1 = NewTriangle(FaceOf(SampleMesh::TriangleOf(ahead)));
        const TriangleIndex slot2 = NewTriangle(FaceOf(SampleMesh::TriangleOf(mesh_.twin[ahead])));
        mesh_.InsertIntoEdge(i, ahead, slot1, slot2);
        ahead = 3 * slot1;
      } else {
        const TriangleIndex slot = NewTriangle(h / 3);
        mesh_.InsertIntoBoundaryEdge(i, ahead, slot);
        ahead = 3 * slot;
      }
      last_half_edge = h;
      last_loop = l;
    }
  }

  /// Triangulates the faces with samples side by side, each by itself, then joins their outlines.
  void InsertInteriorSamples(const Parallel& parallel, Interrupt* interrupt) {
    std::vector<Host> hosts = FindHosts();
    std::vector<std::vector<std::int32_t>> cut = TrianglesOfCutFaces(hosts);
    first_slot_ = mesh_.triangle_count();
    mesh_.origin.resize(mesh_.origin.size() + 6 * interior_.size(), -1);
    mesh_.twin.resize(mesh_.origin.size(), -1);
    if (!mesh_.locked.empty()) mesh_.locked.resize(mesh_.origin.size(), 0);
    moved_.assign(3 * static_cast<std::size_t>(first_slot_), -1);
    const auto count = static_cast<std::int64_t>(hosts.size());
    std::vector<std::vector<OutlineEdge>> outlines((count + kPiece - 1) / kPiece);
    parallel.ForRanges(count, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
      Scratch scratch;
      Interrupt own = stop;
      std::vector<OutlineEdge>* outline = &outlines[static_cast<std::size_t>(first / kPiece)];
      for (std::int64_t k = first; k < end && !own.RequestedAt(k); ++k) {
        const auto host = static_cast<std::size_t>(k);
        Triangulate(hosts[host], cut[host], &scratch, outline, &own);
      }
    });
    if (interrupt->Requested()) return;
    for (const std::vector<OutlineEdge>& outline : outlines) JoinOutline(outline);
  }

  /// Faces with samples, which interior_ lists face by face.
  std::vector<Host> FindHosts() {
    for (std::int32_t i = 0; i < samples_.count(); ++i) {
      if (samples_.kind[i] == SampleMesh::Kind::kInterior) interior_.push_back(i);
    }
    const auto by_face = [&](std::int32_t i, std::int32_t j) {
      return samples_.face[i] < samples_.face[j];
    };
    if (!std::is_sorted(interior_.begin(), interior_.end(), by_face)) {
      std::stable_sort(interior_.begin(), interior_.end(), by_face);
    }
    std::vector<Host> hosts;
    for (std::size_t k = 0; k < interior_.size(); ++k) {
      const std::int32_t face = samples_.face[interior_[k]];
      if (hosts.empty() || hosts.back().face != face) hosts.push_back({face, k, k});
      hosts.back().end = k + 1;
    }
    return hosts;
  }

  /// Per host its triangles where there is more than one.
  std::vector<std::vector<std::int32_t>> TrianglesOfCutFaces(const std::vector<Host>& hosts) const {
    std::vector<std::vector<std::int32_t>> triangles(hosts.size());
    for (std::size_t k = 0; k < cut_.size(); ++k) {
      const auto host = std::lower_bound(
          hosts.begin(), hosts.end(), cut_[k],
          [](const Host& candidate, std::int32_t face) { return candidate.face < face; });
      if (host == hosts.end() || host->face != cut_[k]) continue;
      std::vector<std::int32_t>& own = triangles[host - hosts.begin()];
      if (own.empty()) own.push_back(host->face);
      own.push_back(first_cut_ + static_cast<std::int32_t>(k));
    }
    return triangles;
  }

  /// Writes the triangles of one face but for what lies across its outline. Writes nothing when
  /// `interrupt` was requested.
  void Triangulate(const Host& host, const std::vector<std::int32_t>& cut, Scratch* scratch,
                   std::vector<OutlineEdge>* outline, Interrupt* interrupt) {
    std::vector<std::int32_t>& triangles = scratch->triangles;
    std::vector<std::int32_t>& vertices = scratch->vertices;
    triangles.assign(1, host.face);
    if (!cut.empty()) triangles = cut;
    vertices.clear();
    scratch->place.clear();
    scratch->corners.resize(triangles.size());
    scratch->number.clear();
    // The next vertex gets the number that is not taken yet.
    const auto number_of = [&](std::int32_t v) {
      const auto next = static_cast<std::int32_t>(vertices.size());
      if (triangles.size() > kFewTriangles) return scratch->number.emplace(v, next).first->second;
      const auto known = std::find(vertices.begin(), vertices.end(), v);
      return static_cast<std::int32_t>(known - vertices.begin());
    };
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (interrupt->RequestedAt(static_cast<std::int64_t>(t))) return;
      for (int k = 0; k < 3; ++k) {
        const std::int32_t v = mesh_.origin[3 * triangles[t] + k];
        scratch->corners[t][k] = number_of(v);
        if (scratch->corners[t][k] < static_cast<std::int32_t>(vertices.size())) continue;
        vertices.push_back(v);
        scratch->place.push_back(positions_[v]);
      }
    }
    FaceTriangulation& triangulation = scratch->triangulation;
    if (cut.empty()) {
      triangulation.Start(scratch->place);
    } else {
      triangulation.Start(scratch->place, scratch->corners);
    }
    const SampleMesh& own = triangulation.mesh();
    scratch->outline.resize(vertices.size());
    scratch->is_locked.resize(vertices.size());
    for (std::size_t h = 0; h < own.twin.size(); ++h) {
      if (own.twin[h] >= 0) continue;
      const std::int32_t before = 3 * triangles[h / 3] + static_cast<std::int32_t>(h % 3);
      scratch->outline[own.origin[h]] = {before, mesh_.twin[before], host.face};
      scratch->is_locked[own.origin[h]] = mesh_.IsLocked(before) ? 1 : 0;
    }
    for (std::size_t k = host.first; k < host.end; ++k) {
      if (interrupt->RequestedAfter(1 + triangulation.work() / kStepsAUnit)) return;
      vertices.push_back(interior_[k]);
      triangulation.Insert(positions_[interior_[k]]);
    }
    for (std::size_t k = 2 * host.first; k < 2 * host.end; ++k) {
      triangles.push_back(first_slot_ + static_cast<std::int32_t>(k));
    }
    const auto whole = [&](std::int32_t h) { return 3 * triangles[h / 3] + h % 3; };
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(own.origin.size()); ++h) {
      const std::int32_t e = whole(h);
      const std::int32_t from = own.origin[h];
      mesh_.origin[e] = vertices[from];
      const bool outer = own.twin[h] < 0;
      if (!mesh_.locked.empty()) mesh_.locked[e] = outer ? scratch->is_locked[from] : 0;
      if (outer) {
        moved_[scratch->outline[from].before] = e;
        outline->push_back(scratch->outline[from]);
      } else {
        mesh_.twin[e] = whole(own.twin[h]);
      }
    }
    const std::size_t outer = vertices.size() - (host.end - host.first);
    for (std::size_t v = outer; v < vertices.size(); ++v) {
      mesh_.outgoing[vertices[v]] = whole(own.outgoing[v]);
    }
  }

  void JoinOutline(const std::vector<OutlineEdge>& outline) {
    for (const OutlineEdge& edge : outline) {
      const std::int32_t h = moved_[edge.before];
      const bool is_moved = edge.across >= 0 && moved_[edge.across] >= 0;
      const std::int32_t g = is_moved ? moved_[edge.across] : edge.across;
      mesh_.twin[h] = g;
      if (g >= 0) mesh_.twin[g] = h;
      // Of the half-edges in this face the vertex may have left through any.
      std::int32_t& leave = mesh_.outgoing[mesh_.origin[h]];
      if (leave < 3 * first_slot_ && FaceOf(SampleMesh::TriangleOf(leave)) == edge.face) leave = h;
    }
  }

  SampleMesh mesh_;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<std::int32_t> components_;
  const Surface& surface_;
  const Plan& plan_;
  const Samples& samples_;
  std::vector<std::int32_t> vertex_of_;  // Surface vertex -> work vertex.
  std::vector<std::uint8_t> adopted_;    // Per sample: stands for a surface vertex.
  std::vector<std::int32_t> cut_;        // Faces of the triangles that boundary samples cut off.
  std::int32_t first_cut_ = 0;           // The first of these triangles.
  std::int32_t first_slot_ = 0;          // The first triangle for interior samples.
  std::vector<std::int32_t> interior_;   // Samples inside faces, by face.
  std::vector<std::int32_t> moved_;      // Half-edge before -> now, on outlines of hosts; else -1.
};

}  // namespace

InsertedSamples InsertSamples(const Surface& surface, const Plan& plan, const Samples& samples,
                              const Parallel& parallel, Interrupt* interrupt) {
  Insertion insertion(surface, plan, samples);
  insertion.Run(parallel, interrupt);
  return std::move(insertion).Take();
}

}  // namespace ccst::internal
