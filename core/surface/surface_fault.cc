#include "core/surface/surface_fault.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "absl/strings/str_cat.h"

namespace ccst {
namespace {

std::string FindVertexFault(const Surface& surface, std::size_t v) {
  if (!surface.positions()[v].allFinite()) {
    return absl::StrCat("the position of vertex ", v, " is no number");
  }
  if (!(std::abs(surface.normals()[v].norm() - 1.0) <= 1e-9)) {
    return absl::StrCat("the normal of vertex ", v, " is no unit vector");
  }
  const std::int32_t h = surface.outgoing()[v];
  if (h < 0 || h >= 3 * surface.face_count() || surface.Origin(h) != static_cast<std::int32_t>(v)) {
    return absl::StrCat("the half-edge that leaves vertex ", v, " starts elsewhere");
  }
  return "";
}

std::string FindEdgeFault(const Surface& surface, std::int32_t h) {
  const std::int32_t g = surface.twins()[h];
  const std::int32_t from = surface.Origin(h);
  if (g < 0) {
    return surface.outgoing()[from] == h
               ? ""
               : absl::StrCat("vertex ", from, " is on the boundary and does not leave through it");
  }
  if (g >= 3 * surface.face_count() || surface.twins()[g] != h ||
      surface.Origin(g) != surface.Target(h) || surface.Target(g) != from) {
    return absl::StrCat("half-edge ", h, " and its twin ", g, " do not match");
  }
  if (surface.face_components()[h / 3] != surface.face_components()[g / 3]) {
    return absl::StrCat("faces ", h / 3, " and ", g / 3, " are neighbours in two components");
  }
  return "";
}

}  // namespace

std::string FindFault(const Surface& surface) {
  const auto vertices = static_cast<std::size_t>(surface.vertex_count());
  const auto faces = static_cast<std::size_t>(surface.face_count());
  if (surface.normals().size() != vertices || surface.outgoing().size() != vertices ||
      surface.twins().size() != 3 * faces || surface.face_areas().size() != faces ||
      surface.face_components().size() != faces) {
    return "the arrays of vertices or faces differ in length";
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const Eigen::Vector3i& face = surface.faces()[f];
    if (face.minCoeff() < 0 || face.maxCoeff() >= surface.vertex_count()) {
      return absl::StrCat("face ", f, " has a corner that does not exist");
    }
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (std::string fault = FindVertexFault(surface, v); !fault.empty()) return fault;
  }
  for (std::int32_t h = 0; h < 3 * surface.face_count(); ++h) {
    if (std::string fault = FindEdgeFault(surface, h); !fault.empty()) return fault;
  }
  const std::vector<double>& parts = surface.component_areas();
  const double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
  if (!(std::abs(sum - surface.area()) <= 1e-9 * surface.area())) {
    return absl::StrCat("the components have an area of ", sum, ", all faces one of ",
                        surface.area());
  }
  return "";
}

}  // namespace ccst
