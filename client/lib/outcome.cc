#include "client/lib/outcome.h"

#include "absl/strings/str_cat.h"

namespace ccst {
namespace {

// Weights come from sums of rounded numbers.
constexpr double kSlack = 1e-9;

bool IsShare(double weight) { return weight >= -kSlack && weight <= 1.0 + kSlack; }

// GCC 12 drops a conversion to float and back where it vectorises both; that the float is stored in
// between keeps it.
double RoundedToFloat(double value) {
  const volatile float rounded = static_cast<float>(value);
  return rounded;
}

}  // namespace

absl::Status PlaceSamples(const TriangleMesh& mesh, const Eigen::Vector3d& origin,
                          SampleSet& samples) {
  for (std::size_t i = 0; i < samples.faces.size(); ++i) {
    const std::int32_t face = samples.faces[i];
    if (face < 0 || static_cast<std::size_t>(face) >= mesh.faces.size()) {
      return absl::DataLossError(absl::StrCat("sample ", i, " lies on face ", face,
                                              ", but the mesh has ", mesh.faces.size()));
    }
    const double u = samples.barycentrics[i][0];
    const double v = samples.barycentrics[i][1];
    const double w = 1.0 - u - v;
    if (!IsShare(u) || !IsShare(v) || !IsShare(w)) {
      return absl::DataLossError(
          absl::StrCat("sample ", i, " has the weights ", u, ", ", v, ", outside its face"));
    }
    const Eigen::Vector3i& corners = mesh.faces[face];
    samples.positions[i] = u * mesh.positions[corners[0]] + v * mesh.positions[corners[1]] +
                           w * mesh.positions[corners[2]] + origin;
    for (double& component : samples.normals[i]) component = RoundedToFloat(component);
  }
  return absl::OkStatus();
}

}  // namespace ccst
