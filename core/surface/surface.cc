#include "core/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/assert.h"
#include "core/base/status.h"
#include "core/mesh/edges.h"
#include "core/surface/closest_point.h"
#include "core/surface/corner_sums.h"
#include "core/surface/curvature.h"

namespace ccst {
namespace {

absl::Status Degenerate(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshDegenerate, message);
}

absl::Status NotManifold(const std::string& message) {
  return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshNotManifold, message);
}

/// Faces, edges or vertices that one thread looks at in one go.
constexpr std::int64_t kPiece = 8192;

/// Calls check(first, end) for pieces of [0, count). @return the first error in their order.
template <typename Check>
absl::Status CheckPieces(std::int64_t count, const Parallel& parallel, const Check& check) {
  std::vector<absl::Status> statuses((count + kPiece - 1) / kPiece);
  parallel.ForRanges(count, kPiece, [&](std::int64_t first, std::int64_t end) {
    statuses[static_cast<std::size_t>(first / kPiece)] =
        check(static_cast<std::int32_t>(first), static_cast<std::int32_t>(end));
  });
  for (const absl::Status& status : statuses) CCST_RETURN_IF_ERROR(status);
  return absl::OkStatus();
}

absl::Status Interrupted(const Interrupt& interrupt) {
  return interrupt.Error("the surface was prepared");
}

std::string Describe(const Eigen::Vector3d& p) {
  return absl::StrCat("(", p.x(), ", ", p.y(), ", ", p.z(), ")");
}

absl::Status CheckNumbers(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!mesh.positions[i].allFinite()) {
      return Degenerate(absl::StrCat(
          "vertex ", i, " has a coordinate that is not finite: ", Describe(mesh.positions[i])));
    }
  }
  const auto count = static_cast<std::int64_t>(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.faces[f][k] < 0 || mesh.faces[f][k] >= count) {
        return Degenerate(absl::StrCat("face ", f, " refers to vertex ", mesh.faces[f][k],
                                       "; the mesh has vertices 0 to ", count - 1));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Surface> Surface::Build(const TriangleMesh& mesh, Interrupt* interrupt,
                                       const Parallel& parallel) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  if (mesh.faces.empty()) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty,
                     "the mesh has no faces; at least one of positive area is needed");
  }
  CCST_RETURN_IF_ERROR(CheckNumbers(mesh));

  Surface surface;
  const auto count = static_cast<std::int32_t>(mesh.positions.size());
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3d& position : mesh.positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  surface.center_ = 0.5 * low + 0.5 * high;
  const double half_extent = (0.5 * high - 0.5 * low).maxCoeff();
  if (!(half_extent > 0.0)) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty,
                     absl::StrCat("all vertices lie at ", Describe(low),
                                  "; at least one face of positive area is needed"));
  }
  int exponent = 0;
  std::frexp(half_extent, &exponent);
  surface.unit_ = std::ldexp(1.0, exponent + 1);

  surface.positions_.resize(count);
  for (std::int32_t i = 0; i < count; ++i) {
    surface.positions_[i] = (mesh.positions[i] - surface.center_) / surface.unit_;
  }
  surface.diagonal_ = ((high - low) / surface.unit_).norm();
  surface.faces_ = mesh.faces;
  surface.face_areas_.resize(mesh.faces.size());
  const CornerSums corners(surface.faces_, count);
  CCST_RETURN_IF_ERROR(surface.AddNormals(corners, parallel, interrupt));
  if (!(surface.area_ > 1e-14 * surface.diagonal_ * surface.diagonal_)) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty,
                     "no face has a positive area; all of them are points or line segments");
  }
  CCST_RETURN_IF_ERROR(surface.Connect(parallel, interrupt));
  CCST_RETURN_IF_ERROR(surface.CheckVertices(parallel));
  if (interrupt->Requested()) return Interrupted(*interrupt);
  surface.FindComponentsAndLoops(interrupt);
  surface.shapes_ = VertexShapeTensors(surface.positions_, surface.faces_, corners,
                                       surface.normals_, parallel, interrupt);
  if (interrupt->Requested()) return Interrupted(*interrupt);
  return surface;
}

absl::Status Surface::AddNormals(const CornerSums& corners, const Parallel& parallel,
                                 Interrupt* interrupt) {
  CCST_RETURN_IF_ERROR(
      CheckPieces(face_count(), parallel, [&](std::int32_t first, std::int32_t end) {
        for (std::int32_t f = first; f < end; ++f) {
          const Eigen::Vector3i& face = faces_[f];
          if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) continue;
          return Degenerate(absl::StrCat("face ", f, " (", face[0], ", ", face[1], ", ", face[2],
                                         ") uses one vertex twice; its three corners must differ"));
        }
        return absl::OkStatus();
      }));
  face_areas_.resize(faces_.size());
  normals_.assign(positions_.size(), Eigen::Vector3d::Zero());
  corners.Add(
      parallel, interrupt,
      [&](std::int64_t f, const auto& add) {
        const Eigen::Vector3i& face = faces_[static_cast<std::size_t>(f)];
        const Eigen::Vector3d normal = ccst::FaceCross(positions_, face);
        face_areas_[static_cast<std::size_t>(f)] = 0.5 * normal.norm();
        for (int k = 0; k < 3; ++k) add(k, normal);
      },
      &normals_);
  if (interrupt->Requested()) return Interrupted(*interrupt);
  for (const double area : face_areas_) area_ += area;
  parallel.ForRanges(vertex_count(), kPiece, [&](std::int64_t first, std::int64_t end) {
    for (auto v = static_cast<std::size_t>(first); v < static_cast<std::size_t>(end); ++v) {
      const double norm = normals_[v].norm();
      normals_[v] = norm > 0.0 ? Eigen::Vector3d(normals_[v] / norm) : Eigen::Vector3d::UnitZ();
    }
  });
  return absl::OkStatus();
}

absl::Status Surface::Connect(const Parallel& parallel, Interrupt* interrupt) {
  twins_.assign(3 * faces_.size(), -1);
  EdgeSlots edges(faces_, vertex_count());
  const auto pair = [&](std::span<const std::int32_t> half_edges) {
    if (half_edges.size() == 1) return absl::OkStatus();
    const std::int32_t h = half_edges[0];
    const std::int32_t g = half_edges[1];
    if (half_edges.size() == 2 && Origin(h) != Origin(g)) {
      twins_[h] = g;
      twins_[g] = h;
      return absl::OkStatus();
    }
    const std::int32_t low = std::min(Origin(h), Target(h));
    const std::int32_t high = std::max(Origin(h), Target(h));
    const std::string edge = absl::StrCat("the edge between vertices ", low, " and ", high,
                                          " near ", Describe(ToMesh(positions_[low])));
    if (half_edges.size() > 2) {
      return NotManifold(absl::StrCat(edge, " is shared by more than two faces (", h / 3, ", ",
                                      g / 3, ", ...); at most two may meet at an edge"));
    }
    return NotManifold(absl::StrCat(edge, " is traversed in the same direction by faces ", h / 3,
                                    " and ", g / 3, "; neighbouring faces must be oriented alike"));
  };
  return CheckPieces(vertex_count(), parallel,
                     [&, stop = *interrupt](std::int32_t first, std::int32_t end) -> absl::Status {
                       Interrupt own = stop;
                       if (own.Requested()) return Interrupted(own);
                       absl::Status status;
                       edges.ForEach(first, end, [&](std::span<const std::int32_t> half_edges) {
                         status = pair(half_edges);
                         return status.ok();
                       });
                       return status;
                     });
}

absl::Status Surface::CheckVertices(const Parallel& parallel) {
  const std::int32_t half_edges = 3 * face_count();
  outgoing_.assign(positions_.size(), -1);
  std::vector<std::int32_t> degree(positions_.size(), 0);
  for (std::int32_t h = 0; h < half_edges; ++h) {
    const std::int32_t v = Origin(h);
    ++degree[v];
    if (outgoing_[v] < 0 || twins_[h] < 0) outgoing_[v] = h;
  }
  const auto check = [&](std::int32_t v) {
    if (degree[v] == 0) {
      return NotManifold(absl::StrCat("vertex ", v, " at ", Describe(ToMesh(positions_[v])),
                                      " belongs to no face; every vertex must"));
    }
    std::int32_t seen = 0;
    std::int32_t h = outgoing_[v];
    do {
      ++seen;
      h = twins_[PreviousHalfEdge(h)];
    } while (h >= 0 && h != outgoing_[v] && seen <= degree[v]);
    if (seen == degree[v]) return absl::OkStatus();
    return NotManifold(
        absl::StrCat("vertex ", v, " at ", Describe(ToMesh(positions_[v])), " has ", degree[v],
                     " faces of which only ", seen,
                     " are connected around it; the faces at a vertex must form one fan"));
  };
  return CheckPieces(vertex_count(), parallel,
                     [&](std::int32_t first, std::int32_t end) -> absl::Status {
                       for (std::int32_t v = first; v < end; ++v) {
                         CCST_RETURN_IF_ERROR(check(v));
                       }
                       return absl::OkStatus();
                     });
}

void Surface::FindComponentsAndLoops(Interrupt* interrupt) {
  face_components_.assign(faces_.size(), -1);
  std::vector<std::int32_t> stack;
  std::int64_t seen = 0;
  for (std::int32_t seed = 0; seed < face_count(); ++seed) {
    if (face_components_[seed] >= 0) continue;
    const auto component = static_cast<std::int32_t>(component_areas_.size());
    component_areas_.push_back(0.0);
    component_eulers_.push_back(0);
    face_components_[seed] = component;
    stack.assign(1, seed);
    while (!stack.empty()) {
      if (interrupt->RequestedAt(seen++)) return;
      const std::int32_t face = stack.back();
      stack.pop_back();
      component_areas_[component] += face_areas_[face];
      component_eulers_[component] += 1;
      for (int k = 0; k < 3; ++k) {
        const std::int32_t twin = twins_[3 * face + k];
        if (twin < 3 * face + k) component_eulers_[component] -= 1;  // Each edge once.
        if (twin >= 0 && face_components_[twin / 3] < 0) {
          face_components_[twin / 3] = component;
          stack.push_back(twin / 3);
        }
      }
    }
  }
  for (const std::int32_t h : outgoing_) component_eulers_[face_components_[h / 3]] += 1;

  std::vector<std::uint8_t> visited(twins_.size(), 0);
  for (std::int32_t first = 0; first < 3 * face_count(); ++first) {
    if (interrupt->RequestedAt(first)) return;
    if (twins_[first] >= 0 || visited[first]) continue;
    BoundaryLoop loop;
    loop.component = face_components_[first / 3];
    std::int32_t h = first;
    do {
      visited[h] = 1;
      loop.half_edges.push_back(h);
      loop.length += (positions_[Target(h)] - positions_[Origin(h)]).norm();
      h = outgoing_[Target(h)];
    } while (h != first);
    boundary_loops_.push_back(std::move(loop));
  }
}

Eigen::Vector3d Surface::NormalAt(std::int32_t face, const Eigen::Vector3d& weights) const {
  CCST_ASSERT(face >= 0 && face < face_count());
  const Eigen::Vector3i& corner = faces_[face];
  const Eigen::Vector3d sum = weights[0] * normals_[corner[0]] + weights[1] * normals_[corner[1]] +
                              weights[2] * normals_[corner[2]];
  const double norm = sum.norm();
  return norm > 1e-12 ? Eigen::Vector3d(sum / norm) : normals_[corner[0]];
}

Eigen::Matrix<double, 6, 1> Surface::ShapeAt(std::int32_t face,
                                             const Eigen::Vector3d& weights) const {
  Eigen::Matrix<double, 6, 1> shape;
  const Eigen::Vector3i& corner = faces_[face];
  for (int i = 0; i < 6; ++i) {
    shape[i] = weights[0] * shapes_[corner[0]][i] + weights[1] * shapes_[corner[1]][i] +
               weights[2] * shapes_[corner[2]][i];
  }
  return shape;
}

SurfacePoint Surface::ClosestOnFace(std::int32_t face, const Eigen::Vector3d& target) const {
  CCST_ASSERT(face >= 0 && face < face_count());
  const Eigen::Vector3i& corner = faces_[face];
  const Eigen::Vector3d& a = positions_[corner[0]];
  const Eigen::Vector3d& b = positions_[corner[1]];
  const Eigen::Vector3d& c = positions_[corner[2]];
  const Eigen::Vector3d weights = ClosestWeights(target, a, b, c);
  return {face, weights, weights[0] * a + weights[1] * b + weights[2] * c};
}

SurfacePoint Surface::Follow(std::int32_t face, const Eigen::Vector3d& target) const {
  SurfacePoint best = ClosestOnFace(face, target);
  double distance = (best.position - target).squaredNorm();
  while (true) {
    const int zeros =
        (best.weights[0] == 0.0) + (best.weights[1] == 0.0) + (best.weights[2] == 0.0);
    if (zeros == 0) return best;
    SurfacePoint next = best;
    double next_distance = distance;
    const auto consider = [&](std::int32_t candidate) {
      const SurfacePoint point = ClosestOnFace(candidate, target);
      const double d = (point.position - target).squaredNorm();
      if (d < next_distance) {
        next = point;
        next_distance = d;
      }
    };
    if (zeros == 1) {
      const int opposite = best.weights[0] == 0.0 ? 0 : best.weights[1] == 0.0 ? 1 : 2;
      const std::int32_t twin = twins_[3 * best.face + (opposite + 1) % 3];
      if (twin >= 0) consider(twin / 3);
    } else {
      const int corner = best.weights[0] > 0.0 ? 0 : best.weights[1] > 0.0 ? 1 : 2;
      const std::int32_t start = outgoing_[faces_[best.face][corner]];
      std::int32_t h = start;
      do {
        if (h / 3 != best.face) consider(h / 3);
        h = twins_[PreviousHalfEdge(h)];
      } while (h >= 0 && h != start);
    }
    // A relative margin ends the walk where rounding alone tells the candidates apart.
    if (!(next_distance < distance * (1.0 - 1e-12))) return best;
    best = next;
    distance = next_distance;
  }
}

}  // namespace ccst
