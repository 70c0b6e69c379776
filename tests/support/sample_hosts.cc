#include "tests/support/sample_hosts.h"

#include <cmath>

#include "absl/strings/str_cat.h"

namespace ccst::test {

std::string FindHostFault(const TriangleMesh& mesh, std::int64_t count, const SampleSet& set,
                          const HostTolerance& tolerance) {
  const auto n = static_cast<std::size_t>(count);
  if (set.positions.size() != n || set.faces.size() != n || set.barycentrics.size() != n ||
      set.normals.size() != n) {
    return absl::StrCat(set.positions.size(), " samples instead of ", count);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (set.faces[i] < 0 || set.faces[i] >= static_cast<std::int64_t>(mesh.faces.size())) {
      return absl::StrCat("sample ", i, " has no host");
    }
    const double u = set.barycentrics[i][0];
    const double v = set.barycentrics[i][1];
    if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) {
      return absl::StrCat("sample ", i, " lies outside its host: ", u, ", ", v);
    }
    const Eigen::Vector3i& face = mesh.faces[set.faces[i]];
    const Eigen::Vector3d position = u * mesh.positions[face[0]] + v * mesh.positions[face[1]] +
                                     (1.0 - u - v) * mesh.positions[face[2]];
    if (!((position - set.positions[i]).stableNorm() <= tolerance(face))) {
      return absl::StrCat("sample ", i, " is not where its host says");
    }
    if (!(std::abs(set.normals[i].norm() - 1.0) < 1e-9)) {
      return absl::StrCat("normal ", i, " is no unit vector");
    }
  }
  return "";
}

}  // namespace ccst::test
