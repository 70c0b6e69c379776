#include "core/sampling/initial_mesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/sampling/edge_flips.h"
#include "core/sampling/face_triangulation.h"
#include "core/sampling/thinning.h"
#include "core/sampling/vertex_removal.h"

namespace ccst {
namespace {

/// Faces with samples that one thread triangulates in one go.
constexpr std::int64_t kPiece = 256;
/// Vertices of the surface in a block that is thinned by itself: as many blocks as keep several
/// threads busy, but none so small that most of its vertices lie at its border. Of the number of
/// vertices alone, for the order of removals follows from it.
constexpr std::int32_t kBlocks = 64;
constexpr std::int32_t kLeastBlock = 2048;
/// What was at a border is done in blocks this many times as large, and at last in one.
constexpr std::int32_t kGrowth = 8;

/// The surface's faces with the samples inserted. Vertices: samples, then the surface's own, then
/// one per closed loop.
class Insertion {
 public:
  Insertion(const Surface& surface, const Plan& plan, const Samples& samples)
      : surface_(surface), plan_(plan), samples_(samples) {
    positions = samples.position;
    normals = samples.normal;
    positions.insert(positions.end(), surface.positions().begin(), surface.positions().end());
    normals.insert(normals.end(), surface.normals().begin(), surface.normals().end());
    vertex_of_.resize(surface.vertex_count());
    std::iota(vertex_of_.begin(), vertex_of_.end(), samples.count());
    components = samples.component;
    components.reserve(positions.size());
    for (const std::int32_t h : surface.outgoing()) {
      components.push_back(surface.face_components()[h / 3]);
    }
  }

  /// @return false when stopped.
  bool Run(const Parallel& parallel, Interrupt* interrupt) {
    AdoptCorners();
    if (interrupt->Requested()) return false;
    SetTriangles();
    if (interrupt->Requested()) return false;
    InsertBoundarySamples();
    InsertInteriorSamples(parallel, interrupt);
    return !interrupt->Requested();
  }

  /// Per vertex the block it lies in, each with `size` vertices of the surface that follow each
  /// other in memory, so in space, and the samples there.
  std::vector<std::int32_t> Blocks(std::int32_t size) const {
    std::vector<std::int32_t> blocks;
    blocks.reserve(positions.size());
    for (const std::int32_t face : samples_.face) {
      blocks.push_back(surface_.faces()[face][0] / size);
    }
    for (std::int32_t v = 0; v < surface_.vertex_count(); ++v) blocks.push_back(v / size);
    blocks.resize(positions.size(), 0);
    return blocks;
  }

  SampleMesh mesh;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::int32_t> components;  // Per vertex, of the surface.

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
    mesh.twin = surface_.twins();
    mesh.origin.resize(mesh.twin.size());
    for (std::int32_t f = 0; f < surface_.face_count(); ++f) {
      const bool dead = plan_.components[surface_.face_components()[f]].points;
      for (int k = 0; k < 3; ++k) {
        mesh.origin[3 * f + k] = dead ? -1 : vertex_of_[surface_.faces()[f][k]];
        if (dead) mesh.twin[3 * f + k] = -1;
      }
    }
    std::size_t centers = 0;
    for (const LoopPlan& loop : plan_.loops) centers += loop.closed ? 1 : 0;
    mesh.outgoing.assign(positions.size() + centers, -1);
    for (std::int32_t v = 0; v < surface_.vertex_count(); ++v) {
      const std::int32_t h = surface_.outgoing()[v];
      if (mesh.origin[h] >= 0) mesh.outgoing[vertex_of_[v]] = h;
    }
    for (const LoopPlan& loop : plan_.loops) {
      if (loop.closed) CloseLoop(loop);
    }
    for (const LoopPlan& loop : plan_.loops) {
      if (!loop.crease || plan_.components[loop.component].points) continue;
      for (const std::int32_t h : loop.half_edges) mesh.Lock(h);
    }
  }

  void CloseLoop(const LoopPlan& loop) {
    const auto center = static_cast<std::int32_t>(positions.size());
    const auto first = static_cast<std::int32_t>(mesh.origin.size());
    const auto end = first + 3 * static_cast<std::int32_t>(loop.half_edges.size());
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const std::int32_t h : loop.half_edges) {
      position += surface_.positions()[surface_.Origin(h)];
      normal += surface_.normals()[surface_.Origin(h)];
      // The fan goes on where the next edge of the loop starts.
      const auto side = static_cast<std::int32_t>(mesh.origin.size());
      mesh.origin.insert(mesh.origin.end(),
                         {vertex_of_[surface_.Target(h)], vertex_of_[surface_.Origin(h)], center});
      mesh.twin.insert(mesh.twin.end(), {h, side == first ? end - 1 : side - 1,
                                         side + 3 == end ? first + 1 : side + 4});
      mesh.twin[h] = side;
    }
    mesh.outgoing[center] = first + 2;
    positions.push_back(position / static_cast<double>(loop.half_edges.size()));
    normals.push_back(normal.normalized());
    components.push_back(loop.component);
  }

  /// The face of the surface in which triangle `t` lies.
  std::int32_t FaceOf(std::int32_t t) const {
    return t < first_cut_ ? t : cut_[static_cast<std::size_t>(t - first_cut_)];
  }

  std::int32_t NewTriangle(std::int32_t face) {
    cut_.push_back(face);
    return mesh.NewTriangle();
  }

  void InsertBoundarySamples() {
    first_cut_ = mesh.triangle_count();
    // Samples of one loop come in the order of their arcs; the half-edge that remains ahead of
    // the last one inserted on an edge takes the next one.
    std::int32_t last_half_edge = -1;
    std::int32_t ahead = -1;
    std::int32_t last_loop = -1;
    for (std::int32_t i = 0; i < samples_.count(); ++i) {
      const std::int32_t l = samples_.loop[i];
      if (l < 0 || adopted_[i]) continue;
      const LoopPlan& loop = plan_.loops[l];
      const std::int32_t h = loop.half_edges[loop.Segment(samples_.arc[i])];
      if (l != last_loop || h != last_half_edge) {
        ahead = FindEdgeBetween(vertex_of_[surface_.Origin(h)], vertex_of_[surface_.Target(h)]);
      }
      if (loop.crease) {
        const std::int32_t slot1 = NewTriangle(FaceOf(ahead / 3));
        const std::int32_t slot2 = NewTriangle(FaceOf(mesh.twin[ahead] / 3));
        mesh.InsertIntoEdge(i, ahead, slot1, slot2);
        ahead = 3 * slot1;
      } else {
        const std::int32_t slot = NewTriangle(h / 3);
        mesh.InsertIntoBoundaryEdge(i, ahead, slot);
        ahead = 3 * slot;
      }
      last_half_edge = h;
      last_loop = l;
    }
  }

  /// The half-edge of the work mesh between two vertices that an edge of the surface joins.
  std::int32_t FindEdgeBetween(std::int32_t from, std::int32_t to) const {
    std::int32_t found = -1;
    mesh.ForEachOutgoing(from, [&](std::int32_t h) {
      if (mesh.Target(h) == to) found = h;
    });
    return found;
  }

  /// Triangulates the faces with samples side by side, each by itself, then joins their outlines.
  void InsertInteriorSamples(const Parallel& parallel, Interrupt* interrupt) {
    std::vector<Host> hosts = FindHosts();
    std::vector<std::vector<std::int32_t>> cut = TrianglesOfCutFaces(hosts);
    first_slot_ = mesh.triangle_count();
    mesh.origin.resize(mesh.origin.size() + 6 * interior_.size(), -1);
    mesh.twin.resize(mesh.origin.size(), -1);
    if (!mesh.locked.empty()) mesh.locked.resize(mesh.origin.size(), 0);
    moved_.assign(3 * static_cast<std::size_t>(first_slot_), -1);
    const auto count = static_cast<std::int64_t>(hosts.size());
    std::vector<std::vector<OutlineEdge>> outlines((count + kPiece - 1) / kPiece);
    parallel.ForRanges(count, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
      Scratch scratch;
      Interrupt own = stop;
      std::vector<OutlineEdge>* outline = &outlines[static_cast<std::size_t>(first / kPiece)];
      for (std::int64_t k = first; k < end && !own.RequestedAt(k); ++k) {
        const auto host = static_cast<std::size_t>(k);
        Triangulate(hosts[host], cut[host], &scratch, outline);
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

  /// Writes the triangles of one face but for what lies across its outline.
  void Triangulate(const Host& host, const std::vector<std::int32_t>& cut, Scratch* scratch,
                   std::vector<OutlineEdge>* outline) {
    std::vector<std::int32_t>& triangles = scratch->triangles;
    std::vector<std::int32_t>& vertices = scratch->vertices;
    triangles.assign(1, host.face);
    if (!cut.empty()) triangles = cut;
    vertices.clear();
    scratch->place.clear();
    scratch->corners.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t v = mesh.origin[3 * triangles[t] + k];
        const auto known = std::find(vertices.begin(), vertices.end(), v);
        scratch->corners[t][k] = static_cast<std::int32_t>(known - vertices.begin());
        if (known != vertices.end()) continue;
        vertices.push_back(v);
        scratch->place.push_back(positions[v]);
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
      scratch->outline[own.origin[h]] = {before, mesh.twin[before], host.face};
      scratch->is_locked[own.origin[h]] = mesh.IsLocked(before) ? 1 : 0;
    }
    for (std::size_t k = host.first; k < host.end; ++k) {
      vertices.push_back(interior_[k]);
      triangulation.Insert(positions[interior_[k]]);
    }
    for (std::size_t k = 2 * host.first; k < 2 * host.end; ++k) {
      triangles.push_back(first_slot_ + static_cast<std::int32_t>(k));
    }
    const auto whole = [&](std::int32_t h) { return 3 * triangles[h / 3] + h % 3; };
    for (std::int32_t h = 0; h < static_cast<std::int32_t>(own.origin.size()); ++h) {
      const std::int32_t e = whole(h);
      const std::int32_t from = own.origin[h];
      mesh.origin[e] = vertices[from];
      const bool outer = own.twin[h] < 0;
      if (!mesh.locked.empty()) mesh.locked[e] = outer ? scratch->is_locked[from] : 0;
      if (outer) {
        moved_[scratch->outline[from].before] = e;
        outline->push_back(scratch->outline[from]);
      } else {
        mesh.twin[e] = whole(own.twin[h]);
      }
    }
    const std::size_t outer = vertices.size() - (host.end - host.first);
    for (std::size_t v = outer; v < vertices.size(); ++v) {
      mesh.outgoing[vertices[v]] = whole(own.outgoing[v]);
    }
  }

  void JoinOutline(const std::vector<OutlineEdge>& outline) {
    for (const OutlineEdge& edge : outline) {
      const std::int32_t h = moved_[edge.before];
      const bool is_moved = edge.across >= 0 && moved_[edge.across] >= 0;
      const std::int32_t g = is_moved ? moved_[edge.across] : edge.across;
      mesh.twin[h] = g;
      if (g >= 0) mesh.twin[g] = h;
      // Of the half-edges in this face the vertex may have left through any.
      std::int32_t& leave = mesh.outgoing[mesh.origin[h]];
      if (leave < 3 * first_slot_ && FaceOf(leave / 3) == edge.face) leave = h;
    }
  }

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

/// The live triangles over the samples for whose vertices `wanted` holds, ordered by their smallest
/// vertex, as a mesh of `vertex_count` vertices.
template <typename Wanted>
SampleMesh Compact(const SampleMesh& mesh, std::int32_t vertex_count, const Wanted& wanted) {
  const auto is_live = [&](std::int32_t t) {
    return !mesh.IsDead(t) && wanted(mesh.origin[3 * t]);
  };
  const auto first_corner = [&](std::int32_t t) {
    const std::int32_t* corner = &mesh.origin[3 * t];
    return corner[0] < corner[1] ? (corner[0] < corner[2] ? 0 : 2)
                                 : (corner[1] < corner[2] ? 1 : 2);
  };
  std::vector<std::int32_t> start(vertex_count + 1, 0);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (is_live(t)) ++start[mesh.origin[3 * t + first_corner(t)] + 1];
  }
  for (std::int32_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  std::vector<std::int32_t> sources(3 * static_cast<std::size_t>(start[vertex_count]));
  std::vector<std::int32_t> number(mesh.origin.size(), -1);  // Half-edge before -> now.
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!is_live(t)) continue;
    const int first = first_corner(t);
    const std::int32_t place = start[mesh.origin[3 * t + first]]++;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t h = 3 * t + (first + k) % 3;
      sources[3 * place + k] = h;
      number[h] = 3 * place + k;
    }
  }
  SampleMesh result;
  result.origin.reserve(sources.size());
  result.twin.reserve(sources.size());
  for (const std::int32_t h : sources) {
    result.origin.push_back(mesh.origin[h]);
    result.twin.push_back(mesh.twin[h] < 0 ? -1 : number[mesh.twin[h]]);
    if (!mesh.locked.empty()) result.locked.push_back(mesh.locked[h]);
  }
  result.outgoing.reserve(vertex_count);
  for (std::int32_t v = 0; v < vertex_count; ++v) {
    result.outgoing.push_back(mesh.outgoing[v] < 0 ? -1 : number[mesh.outgoing[v]]);
  }
  return result;
}

absl::Status Stopped() {
  return absl::CancelledError("stopped while the first triangulation was built");
}

}  // namespace

absl::StatusOr<SampleMesh> BuildInitialMesh(const Surface& surface, const Plan& plan,
                                            const Samples& samples, Interrupt* interrupt,
                                            std::vector<std::int32_t>* failed,
                                            const Parallel& parallel) {
  Insertion insertion(surface, plan, samples);
  if (!insertion.Run(parallel, interrupt)) return Stopped();
  const auto thin = [&](std::int32_t size) {
    ThinBlocks(samples.count(), insertion.Blocks(size), insertion.positions, insertion.normals,
               parallel, interrupt, &insertion.mesh);
  };
  const std::int32_t count = surface.vertex_count();
  for (std::int32_t size = std::max(kLeastBlock, count / kBlocks); size < count;) {
    thin(size);
    size = size < count / kGrowth ? kGrowth * size : count;
  }
  thin(count);
  CCST_ASSIGN_OR_RETURN(const std::vector<std::int32_t> left,
                        RemoveVertices(samples.count(), insertion.positions, insertion.normals,
                                       interrupt, &insertion.mesh));
  if (!left.empty() && failed == nullptr) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
                     absl::StrCat("sample_count ", samples.count(),
                                  " is too small for the topology of the surface"));
  }
  std::vector<std::uint8_t> wanted(plan.components.size(), 1);
  for (const std::int32_t v : left) {
    const std::int32_t c = insertion.components[v];
    if (std::exchange(wanted[c], 0)) failed->push_back(c);
  }
  if (interrupt->Requested()) return Stopped();
  SampleMesh mesh = Compact(insertion.mesh, samples.count(),
                            [&](std::int32_t v) { return wanted[insertion.components[v]] != 0; });
  EdgeFlips(&mesh, &samples.position, &samples.normal).FlipAll(interrupt);
  if (interrupt->Requested()) return Stopped();
  return mesh;
}

}  // namespace ccst
