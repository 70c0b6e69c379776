#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/draco_points.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"

namespace ccst {
namespace {

Eigen::AlignedBox3d BoundingBox(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : mesh.positions) box.extend(position);
  return box;
}

// The length of the diagonal, also where its square overflows or vanishes.
double Diagonal(const Eigen::AlignedBox3d& box) {
  return box.isEmpty() ? 0.0 : box.diagonal().stableNorm();
}

}  // namespace

Eigen::Vector3d ChooseOrigin(const TriangleMesh& mesh) {
  constexpr double kNearDiagonals = 16.0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  const double diagonal = Diagonal(box);
  if (!(diagonal > 0.0) || !std::isfinite(diagonal)) return origin;
  // A multiple of a power of two near the diagonal: subtracting it from a float of this size
  // leaves a float, so that nothing is rounded that was not before.
  const double step = std::exp2(std::ceil(std::log2(diagonal)));
  for (int axis = 0; axis < 3; ++axis) {
    const double farthest = std::max(std::abs(box.min()[axis]), std::abs(box.max()[axis]));
    if (!(farthest > kNearDiagonals * diagonal)) continue;
    const double centre = box.min()[axis] + 0.5 * (box.max()[axis] - box.min()[axis]);
    origin[axis] = std::round(centre / step) * step;
  }
  return origin.allFinite() ? origin : Eigen::Vector3d::Zero();
}

absl::StatusOr<TriangleMesh> ToWirePrecision(const TriangleMesh& mesh,
                                             const Eigen::Vector3d& origin) {
  CCST_RETURN_IF_ERROR(CheckAttributes(mesh));
  TriangleMesh result;
  result.positions.reserve(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    Eigen::Vector3d position = mesh.positions[i] - origin;
    for (double& coordinate : position) coordinate = io::RoundedToFloat(coordinate);
    if (!position.allFinite()) {
      return io::Degenerate(absl::StrCat(
          "vertex ", i, " (counted from 0) has a coordinate that is no finite 32-bit float (at ",
          "most 3.4e38); scale the mesh down"));
    }
    result.positions.push_back(position);
  }
  // Below the smallest normal float the grid of floats is as coarse as the mesh.
  const double diagonal = Diagonal(BoundingBox(mesh));
  if (diagonal > 0.0 && diagonal < static_cast<double>(std::numeric_limits<float>::min())) {
    return io::Degenerate(absl::StrCat("the bounding box's diagonal is ", diagonal,
                                       "; 32-bit floats need at least 1.2e-38; scale the mesh up"));
  }
  result.faces = mesh.faces;
  result.attributes = mesh.attributes;
  return io::ToStreamLayout(std::move(result));
}

}  // namespace ccst
