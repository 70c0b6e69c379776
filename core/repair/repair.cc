#include "core/repair/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/repair/crowded_edges.h"
#include "core/repair/edge_links.h"
#include "core/repair/fans.h"
#include "core/repair/geometry.h"
#include "core/repair/linked_faces.h"
#include "core/repair/orientation.h"
#include "core/repair/soundness.h"
#include "core/repair/weld.h"
#include "core/repair/zero_area.h"

namespace ccst {
namespace {

using repair::Geometry;
using repair::LinkedFaces;

constexpr double kLargestExtent = 1e300;
constexpr std::size_t kMostFaces = 700'000'000;  // Three slots each in 31 bits.
constexpr std::size_t kMostVertices = 2'000'000'000;
constexpr std::array<std::int8_t, 3> kOwnCorners = {0, 1, 2};

absl::Status Refuse(ErrorReason reason, const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, reason, message);
}

std::string Describe(const Eigen::Vector3d& p) {
  return absl::StrCat("(", p.x(), ", ", p.y(), ", ", p.z(), ")");
}

absl::Status CheckInput(const TriangleMesh& mesh, const RepairOptions& options) {
  if (!(options.weld_tolerance >= 0.0) || !std::isfinite(options.weld_tolerance)) {
    return Refuse(ErrorReason::kOptionInvalid,
                  absl::StrCat("weld_tolerance is ", options.weld_tolerance,
                               "; it must be a finite length, at least 0"));
  }
  if (mesh.faces.empty()) {
    return Refuse(ErrorReason::kMeshEmpty,
                  "the mesh has no faces; at least one of positive area is needed");
  }
  if (mesh.faces.size() > kMostFaces || mesh.positions.size() > kMostVertices) {
    return Refuse(ErrorReason::kLimitExceeded,
                  absl::StrCat("the mesh has ", mesh.faces.size(), " faces and ",
                               mesh.positions.size(), " vertices; at most ", kMostFaces, " and ",
                               kMostVertices, " can be repaired"));
  }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.positions[i].allFinite()) continue;
    return Refuse(ErrorReason::kMeshDegenerate,
                  absl::StrCat("vertex ", i, " has a coordinate that is not finite: ",
                               Describe(mesh.positions[i])));
  }
  const auto count = static_cast<std::int64_t>(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.faces[f][k] >= 0 && mesh.faces[f][k] < count) continue;
      return Refuse(ErrorReason::kMeshDegenerate,
                    absl::StrCat("face ", f, " refers to vertex ", mesh.faces[f][k],
                                 "; the mesh has vertices 0 to ", count - 1));
    }
  }
  return absl::OkStatus();
}

/// V: whether a face uses the vertex.
std::vector<std::uint8_t> UsedVertices(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.positions.size(), 0);
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) used[face[k]] = 1;
  }
  return used;
}

/// Power of two of the size of the `used` part of the mesh; 0 where all of it is one place.
double UnitOf(const TriangleMesh& mesh, const std::vector<std::uint8_t>& used) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!used[i]) continue;
    low = low.cwiseMin(mesh.positions[i]);
    high = high.cwiseMax(mesh.positions[i]);
  }
  const double half_extent = (0.5 * high - 0.5 * low).maxCoeff();
  if (!(half_extent > 0.0)) return 0.0;
  int exponent = 0;
  std::frexp(half_extent, &exponent);
  return std::ldexp(1.0, exponent + 1);
}

/// The same share of area to size under which core/surface finds nothing to sample.
absl::Status CheckArea(const TriangleMesh& input, const TriangleMesh& result) {
  double area = 0.0;
  double unit = 0.0;
  if (!result.faces.empty()) unit = UnitOf(result, UsedVertices(result));
  if (unit > 0.0) {
    const Geometry geometry(result.positions, unit);
    for (const Eigen::Vector3i& t : result.faces) {
      area += 0.5 * geometry.Edge(t[0], t[1]).cross(geometry.Edge(t[0], t[2])).norm();
    }
  }
  // The longest side is at least half a unit and the diagonal at most the root of three.
  if (area > 4e-14) return absl::OkStatus();
  const Eigen::Vector3i& face = input.faces[0];
  return Refuse(ErrorReason::kMeshEmpty,
                absl::StrCat("no face has a positive area: face 0 (", face[0], ", ", face[1], ", ",
                             face[2], ") and all others are points or line segments, near ",
                             Describe(input.positions[face[0]])));
}

/// The faces with the leaders of their vertices, without those that use one twice.
LinkedFaces WeldFaces(const TriangleMesh& mesh, const std::vector<std::int32_t>& leaders,
                      std::int64_t* repeated) {
  LinkedFaces linked;
  linked.faces.reserve(mesh.faces.size());
  linked.source.reserve(mesh.faces.size());
  linked.source_corner.reserve(mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const Eigen::Vector3i& in = mesh.faces[f];
    const Eigen::Vector3i face(leaders[in[0]], leaders[in[1]], leaders[in[2]]);
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      ++*repeated;
      continue;
    }
    linked.faces.push_back(face);
    linked.source.push_back(static_cast<std::int32_t>(f));
    linked.source_corner.push_back(kOwnCorners);
  }
  return linked;
}

/// Per fan the smallest vertex of the input among its corners. Faces must not be turned yet.
std::vector<std::int32_t> InputVertices(const TriangleMesh& mesh, const LinkedFaces& linked,
                                        std::size_t fan_count) {
  std::vector<std::int32_t> first(fan_count, std::numeric_limits<std::int32_t>::max());
  for (std::int32_t f = 0; f < linked.count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      std::int32_t& vertex = first[linked.faces[f][k]];
      vertex = std::min(vertex, mesh.faces[linked.source[f]][k]);
    }
  }
  return first;
}

/// Counts what became of the input's vertices. Those that were joined and came apart again in as
/// many fans were neither welded nor cut.
/// @param fans per leader the fans in use. Consumed.
void CountVertices(const std::vector<std::uint8_t>& used, const std::vector<std::int32_t>& leaders,
                   std::vector<std::int32_t> fans, RepairReport* report) {
  std::vector<std::int32_t> members(leaders.size(), 0);
  for (std::size_t i = 0; i < leaders.size(); ++i) {
    if (used[i]) ++members[leaders[i]];
  }
  for (std::size_t i = 0; i < leaders.size(); ++i) {
    if (!used[i]) ++report->isolated_vertices;
    if (members[i] == 0) continue;
    if (fans[i] == 0) {
      ++report->isolated_vertices;
      fans[i] = 1;
    }
    report->welded_vertices += std::max(0, members[i] - fans[i]);
    report->cut_vertices += std::max(0, fans[i] - members[i]);
  }
}

/// Replaces fans by vertices: each fan in use takes the place of its input vertex in the input's
/// order; where that is taken, a copy at the end.
TriangleMesh Assemble(const TriangleMesh& mesh, const std::vector<std::int32_t>& input_vertices,
                      std::vector<Eigen::Vector3i> faces) {
  std::vector<std::uint8_t> in_use(input_vertices.size(), 0);
  for (const Eigen::Vector3i& face : faces) {
    for (int k = 0; k < 3; ++k) in_use[face[k]] = 1;
  }
  std::vector<std::int32_t> owner(mesh.positions.size(), -1);
  std::vector<std::int32_t> copies;
  for (std::size_t fan = 0; fan < input_vertices.size(); ++fan) {
    if (!in_use[fan]) continue;
    if (owner[input_vertices[fan]] < 0) {
      owner[input_vertices[fan]] = static_cast<std::int32_t>(fan);
    } else {
      copies.push_back(static_cast<std::int32_t>(fan));
    }
  }
  TriangleMesh result;
  std::vector<std::int32_t> number(input_vertices.size(), -1);
  const auto add = [&](std::int32_t fan) {
    number[fan] = static_cast<std::int32_t>(result.positions.size());
    result.positions.push_back(mesh.positions[input_vertices[fan]]);
  };
  for (const std::int32_t fan : owner) {
    if (fan >= 0) add(fan);
  }
  for (const std::int32_t fan : copies) add(fan);
  result.faces = std::move(faces);
  for (Eigen::Vector3i& face : result.faces) {
    for (int k = 0; k < 3; ++k) face[k] = number[face[k]];
  }
  return result;
}

}  // namespace

absl::StatusOr<RepairedMesh> Repair(const TriangleMesh& mesh, const RepairOptions& options,
                                    Interrupt* interrupt, const Parallel& parallel) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  CCST_RETURN_IF_ERROR(CheckInput(mesh, options));
  const std::vector<std::uint8_t> used = UsedVertices(mesh);
  const double unit = UnitOf(mesh, used);
  if (!(unit > 0.0)) return CheckArea(mesh, {});
  if (!(unit <= kLargestExtent)) {
    return Refuse(ErrorReason::kMeshDegenerate,
                  absl::StrCat("the mesh extends over about ", unit, "; at most ", kLargestExtent,
                               " can be computed with"));
  }

  const Geometry geometry(mesh.positions, unit);
  RepairedMesh result;
  if (options.weld_tolerance == 0.0 && repair::IsSound(mesh, used, geometry, parallel, interrupt)) {
    result.mesh.positions = mesh.positions;
    result.mesh.faces = mesh.faces;
    result.source_face.resize(mesh.faces.size());
    std::iota(result.source_face.begin(), result.source_face.end(), 0);
    result.source_corner.assign(mesh.faces.size(), kOwnCorners);
    CCST_RETURN_IF_ERROR(CheckArea(mesh, result.mesh));
    return result;
  }
  RepairReport& report = result.report;
  const auto vertex_count = static_cast<std::int64_t>(mesh.positions.size());
  const auto stopped = [interrupt] { return interrupt->Error("the mesh was repaired"); };
  if (interrupt->Requested()) return stopped();
  const std::vector<std::int32_t> leaders =
      repair::WeldLeaders(mesh.positions, used, options.weld_tolerance, interrupt);
  if (interrupt->Requested()) return stopped();
  LinkedFaces linked = WeldFaces(mesh, leaders, &report.repeated_index_faces);
  report.duplicate_faces = repair::DropDuplicates(&linked, vertex_count, interrupt);
  if (interrupt->Requested()) return stopped();
  repair::CrowdedEdges crowded = repair::LinkPlainEdges(mesh.faces, leaders, &linked, interrupt);
  if (crowded.any) {
    report.degenerate_faces =
        repair::DropHangingSlivers(geometry, &linked, vertex_count, interrupt);
    if (interrupt->Requested()) return stopped();
    if (report.degenerate_faces > 0) {
      crowded = repair::LinkPlainEdges(mesh.faces, leaders, &linked, interrupt);
    }
  }
  if (interrupt->Requested()) return stopped();
  report.cut_edges = static_cast<std::int64_t>(crowded.count());
  repair::Orientation orientation =
      repair::OrientAlongLinks(&linked, &report.non_orientable_cuts, interrupt);
  if (interrupt->Requested()) return stopped();
  repair::LinkCrowdedEdges(geometry, crowded, &orientation, &linked, interrupt);

  if (interrupt->Requested()) return stopped();
  const std::vector<std::int32_t> fan_leaders = repair::SplitFans(&linked, interrupt);
  if (interrupt->Requested()) return stopped();
  const std::vector<std::int32_t> input_vertices = InputVertices(mesh, linked, fan_leaders.size());
  if (interrupt->Requested()) return stopped();
  report.flipped_faces =
      repair::ApplyOrientation(geometry, input_vertices, &orientation, &linked, interrupt);
  if (interrupt->Requested()) return stopped();
  const repair::ZeroAreaReport zero_area =
      repair::RemoveZeroArea(geometry, input_vertices, &linked, interrupt);
  if (interrupt->Requested()) return stopped();
  report.degenerate_faces += zero_area.removed;
  report.split_faces = zero_area.splits;

  std::vector<std::int32_t> fans(mesh.positions.size(), 0);
  std::vector<std::uint8_t> seen(fan_leaders.size(), 0);
  for (const Eigen::Vector3i& face : linked.faces) {
    for (int k = 0; k < 3; ++k) {
      if (!std::exchange(seen[face[k]], 1)) ++fans[fan_leaders[face[k]]];
    }
  }
  CountVertices(used, leaders, std::move(fans), &report);
  result.mesh = Assemble(mesh, input_vertices, std::move(linked.faces));
  result.source_face = std::move(linked.source);
  result.source_corner = std::move(linked.source_corner);
  CCST_RETURN_IF_ERROR(CheckArea(mesh, result.mesh));
  return result;
}

}  // namespace ccst
