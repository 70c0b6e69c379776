#include "core/sampling/mesh/faults.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"

namespace ccst::internal {
namespace {

/// Rounding of positions and weights, in the surface's unit.
constexpr double kRounding = 1e-9;
/// Passes keep normals in single precision.
constexpr double kNormalRounding = 1e-5;

std::string FindTwinFault(const SampleMesh& mesh, std::int32_t h) {
  const std::int32_t from = mesh.origin[h];
  const std::int32_t to = mesh.Target(h);
  if (from < 0 || from >= mesh.vertex_count()) {
    return absl::StrCat("half-edge ", h, " starts at ", from, ", which is no vertex");
  }
  if (from == to) return absl::StrCat("half-edge ", h, " ends where it starts, at ", from);
  const std::int32_t g = mesh.twin[h];
  if (g < 0) return "";
  if (g >= static_cast<std::int32_t>(mesh.twin.size()) || mesh.IsDead(SampleMesh::TriangleOf(g)) ||
      mesh.twin[g] != h || mesh.origin[g] != to || mesh.Target(g) != from) {
    return absl::StrCat("half-edge ", h, " and its twin ", g, " do not match");
  }
  if (mesh.IsLocked(h) != mesh.IsLocked(g)) {
    return absl::StrCat("half-edge ", h, " and its twin ", g, " are not both locked");
  }
  return "";
}

/// @param degree  triangles at `v`.
std::string FindFanFault(const SampleMesh& mesh, std::int32_t v, std::int32_t degree) {
  const std::int32_t start = mesh.outgoing[v];
  if (start < 0) {
    return degree == 0 ? "" : absl::StrCat("vertex ", v, " has triangles but no half-edge");
  }
  if (start >= static_cast<std::int32_t>(mesh.origin.size()) || mesh.origin[start] != v) {
    return absl::StrCat("outgoing half-edge of ", v, " starts elsewhere");
  }
  std::int32_t seen = 0;
  std::int32_t h = start;
  do {
    ++seen;
    h = mesh.Rotate(h);
  } while (h >= 0 && h != start && seen <= degree);
  if (seen != degree) {
    return absl::StrCat("walking around ", v, " sees ", seen, " of ", degree, " triangles");
  }
  if (h < 0 && mesh.twin[start] >= 0) {
    return absl::StrCat("vertex ", v, " is on the boundary and does not leave through it");
  }
  return "";
}

}  // namespace

std::string FindFault(const SampleMesh& mesh) {
  if (mesh.origin.size() % 3 != 0 || mesh.twin.size() != mesh.origin.size() ||
      (!mesh.locked.empty() && mesh.locked.size() != mesh.origin.size())) {
    return "the arrays of half-edges differ in length";
  }
  std::vector<std::int32_t> degree(mesh.outgoing.size(), 0);
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh.origin.size()); ++h) {
    if (mesh.IsDead(SampleMesh::TriangleOf(h))) continue;
    if (std::string fault = FindTwinFault(mesh, h); !fault.empty()) return fault;
    ++degree[mesh.origin[h]];
  }
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (std::string fault = FindFanFault(mesh, v, degree[v]); !fault.empty()) return fault;
  }
  return "";
}

std::string FindFault(const Samples& samples, const Surface& surface) {
  const std::size_t count = samples.position.size();
  for (const std::size_t size :
       {samples.normal.size(), samples.face.size(), samples.weights.size(), samples.kind.size(),
        samples.component.size(), samples.loop.size(), samples.arc.size()}) {
    if (size != count)
      return absl::StrCat("there are ", count, " samples, but ", size,
                          " of one kind of their data");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t face = samples.face[i];
    if (face < 0 || face >= surface.face_count()) {
      return absl::StrCat("the host of sample ", i, " is ", face, ", which is no face");
    }
    const Eigen::Vector3d& weights = samples.weights[i];
    if (!(weights.minCoeff() >= -kRounding) || !(std::abs(weights.sum() - 1.0) <= kRounding)) {
      return absl::StrCat("the weights of sample ", i, " are not in its host");
    }
    const Eigen::Vector3i& corner = surface.faces()[face];
    const Eigen::Vector3d there = weights[0] * surface.positions()[corner[0]] +
                                  weights[1] * surface.positions()[corner[1]] +
                                  weights[2] * surface.positions()[corner[2]];
    if (!((samples.position[i] - there).norm() <= kRounding)) {
      return absl::StrCat("sample ", i, " is not where its host and weights say");
    }
    if (!(std::abs(samples.normal[i].norm() - 1.0) <= kNormalRounding)) {
      return absl::StrCat("the normal of sample ", i, " is no unit vector");
    }
    if (samples.component[i] != surface.face_components()[face]) {
      return absl::StrCat("sample ", i, " is said to be of another component than its host");
    }
  }
  return "";
}

}  // namespace ccst::internal
