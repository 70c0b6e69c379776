#include "core/sampling/initial_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/sampling/edge_flips.h"
#include "core/sampling/vertex_removal.h"

namespace ccst {
namespace {

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
  bool Run(Interrupt* interrupt) {
    AdoptCorners();
    if (interrupt->Requested()) return false;
    SetTriangles();
    InsertBoundarySamples();
    for (std::int32_t i = 0; i < samples_.count(); ++i) {
      if (samples_.kind[i] != SampleMesh::Kind::kInterior) continue;
      if (interrupt->RequestedAt(i)) return false;
      InsertInterior(i);
    }
    return true;
  }

  SampleMesh mesh;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::int32_t> components;  // Per vertex, of the surface.

 private:
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

  void SetTriangles() {
    std::vector<Eigen::Vector3i> triangles(surface_.face_count());
    for (std::int32_t f = 0; f < surface_.face_count(); ++f) {
      if (plan_.components[surface_.face_components()[f]].points) {
        triangles[f].setConstant(-1);
        continue;
      }
      for (int k = 0; k < 3; ++k) triangles[f][k] = vertex_of_[surface_.faces()[f][k]];
    }
    triangle_face_.resize(surface_.face_count());
    std::iota(triangle_face_.begin(), triangle_face_.end(), 0);
    for (std::size_t l = 0; l < plan_.loops.size(); ++l) {
      if (!plan_.loops[l].closed) continue;
      const auto center = static_cast<std::int32_t>(positions.size());
      Eigen::Vector3d position = Eigen::Vector3d::Zero();
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      const std::vector<std::int32_t>& chain = plan_.loops[l].half_edges;
      for (const std::int32_t h : chain) {
        position += surface_.positions()[surface_.Origin(h)];
        normal += surface_.normals()[surface_.Origin(h)];
        triangles.push_back(
            {vertex_of_[surface_.Target(h)], vertex_of_[surface_.Origin(h)], center});
        triangle_face_.push_back(-1);
      }
      positions.push_back(position / static_cast<double>(chain.size()));
      normals.push_back(normal.normalized());
      components.push_back(plan_.loops[l].component);
    }
    mesh.SetTriangles(static_cast<std::int32_t>(positions.size()), triangles);
    last_of_face_.assign(surface_.face_count(), -1);
    for (const LoopPlan& loop : plan_.loops) {
      if (!loop.crease || plan_.components[loop.component].points) continue;
      for (const std::int32_t h : loop.half_edges) mesh.Lock(h);
    }
  }

  std::int32_t NewTriangle(std::int32_t face) {
    triangle_face_.push_back(face);
    return mesh.NewTriangle();
  }

  void InsertBoundarySamples() {
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
        const std::int32_t slot1 = NewTriangle(triangle_face_[ahead / 3]);
        const std::int32_t slot2 = NewTriangle(triangle_face_[mesh.twin[ahead] / 3]);
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

  double Side(std::int32_t h, const Eigen::Vector3d& p, const Eigen::Vector3d& up) const {
    const Eigen::Vector3d& a = positions[mesh.origin[h]];
    return (positions[mesh.Target(h)] - a).cross(p - a).dot(up);
  }

  /// The triangle of face `face` that holds `p`: a walk, or every triangle when it runs in circles.
  std::int32_t Locate(std::int32_t face, const Eigen::Vector3d& p, const Eigen::Vector3d& up) {
    std::int32_t t = last_of_face_[face] >= 0 ? last_of_face_[face] : face;
    for (int step = 0; step < 10000; ++step) {
      double worst = 0.0;
      std::int32_t cross = -1;
      for (std::int32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const double side = Side(h, p, up);
        const std::int32_t twin = mesh.twin[h];
        if (side < worst && twin >= 0 && triangle_face_[twin / 3] == face) {
          worst = side;
          cross = twin / 3;
        }
      }
      if (cross < 0) break;
      t = cross;
    }
    return t;
  }

  void InsertInterior(std::int32_t i) {
    const std::int32_t face = samples_.face[i];
    const Eigen::Vector3i& corner = surface_.faces()[face];
    const Eigen::Vector3d up =
        (surface_.positions()[corner[1]] - surface_.positions()[corner[0]])
            .cross(surface_.positions()[corner[2]] - surface_.positions()[corner[0]]);
    const std::int32_t t = Locate(face, positions[i], up);
    const std::int32_t slot1 = NewTriangle(face);
    const std::int32_t slot2 = NewTriangle(face);
    mesh.InsertIntoTriangle(i, t, slot1, slot2);
    last_of_face_[face] = t;
    // Keep the face's own triangulation Delaunay so that the walks stay short.
    for (const std::int32_t e : {3 * t, 3 * slot1, 3 * slot2}) stack_.push_back(e);
    while (!stack_.empty()) {
      const std::int32_t h = stack_.back();
      stack_.pop_back();
      const std::int32_t g = mesh.twin[h];
      if (g < 0 || triangle_face_[g / 3] != face || !InCircle(h, up) || !mesh.CanFlip(h)) continue;
      mesh.Flip(h);
      // The two edges away from sample i may now violate the criterion.
      for (const std::int32_t e : {h, g}) {
        for (const std::int32_t side : {SampleMesh::Next(e), SampleMesh::Previous(e)}) {
          if (mesh.Apex(side) == i) stack_.push_back(side);
        }
      }
    }
  }

  /// True when the edge `h` of two coplanar triangles is not Delaunay and the flip is a proper one.
  bool InCircle(std::int32_t h, const Eigen::Vector3d& up) const {
    const std::int32_t g = mesh.twin[h];
    const Eigen::Vector3d& a = positions[mesh.origin[h]];
    const Eigen::Vector3d& b = positions[mesh.origin[g]];
    const Eigen::Vector3d& c = positions[mesh.Apex(h)];
    const Eigen::Vector3d& d = positions[mesh.Apex(g)];
    const double cos_c = (a - c).dot(b - c);
    const double cos_d = (a - d).dot(b - d);
    if (cos_c >= 0.0 && cos_d >= 0.0) return false;
    const double sin_c = (a - c).cross(b - c).dot(up);
    const double sin_d = (b - d).cross(a - d).dot(up);
    const double up_norm = up.norm();
    const double margin =
        1e-10 * up_norm * (std::abs(cos_c) + sin_c / up_norm) * (std::abs(cos_d) + sin_d / up_norm);
    if (!(sin_c * cos_d + cos_c * sin_d < -margin)) return false;
    return (c - d).cross(a - d).dot(up) > 0.0 && (d - c).cross(b - c).dot(up) > 0.0;
  }

  const Surface& surface_;
  const Plan& plan_;
  const Samples& samples_;
  std::vector<std::int32_t> vertex_of_;      // Surface vertex -> work vertex.
  std::vector<std::uint8_t> adopted_;        // Per sample: stands for a surface vertex.
  std::vector<std::int32_t> triangle_face_;  // Work triangle -> face of the surface, -1 in a fan.
  std::vector<std::int32_t> last_of_face_;
  std::vector<std::int32_t> stack_;
};

/// Live triangles over the samples for whose vertices `wanted` holds, ordered by their smallest
/// one.
template <typename Wanted>
std::vector<Eigen::Vector3i> LiveTriangles(const SampleMesh& mesh, std::int32_t vertex_count,
                                           const Wanted& wanted) {
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
  std::vector<Eigen::Vector3i> triangles(start[vertex_count]);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (!is_live(t)) continue;
    const int first = first_corner(t);
    const std::int32_t v = mesh.origin[3 * t + first];
    triangles[start[v]++] = {v, mesh.origin[3 * t + (first + 1) % 3],
                             mesh.origin[3 * t + (first + 2) % 3]};
  }
  return triangles;
}

absl::Status Stopped() {
  return absl::CancelledError("stopped while the first triangulation was built");
}

}  // namespace

absl::StatusOr<SampleMesh> BuildInitialMesh(const Surface& surface, const Plan& plan,
                                            const Samples& samples, Interrupt* interrupt,
                                            std::vector<std::int32_t>* failed) {
  Insertion insertion(surface, plan, samples);
  if (!insertion.Run(interrupt)) return Stopped();
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
  SampleMesh mesh;
  mesh.SetTriangles(samples.count(),
                    LiveTriangles(insertion.mesh, samples.count(), [&](std::int32_t v) {
                      return wanted[insertion.components[v]] != 0;
                    }));
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(insertion.mesh.locked.size()); ++h) {
    const std::int32_t from = insertion.mesh.origin[h];
    if (!insertion.mesh.locked[h] || from < 0 || !wanted[insertion.components[from]]) continue;
    mesh.Lock(mesh.FindEdge(from, insertion.mesh.Target(h)));
  }
  EdgeFlips(&mesh, &samples.position, &samples.normal).FlipAll(interrupt);
  if (interrupt->Requested()) return Stopped();
  return mesh;
}

}  // namespace ccst
