#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/portable_math.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/draco_points.h"
#include "core/io/float_positions.h"
#include "core/mesh/attributes.h"

namespace ccst {
namespace {

Eigen::AlignedBox3d BoundingBox(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : mesh.positions) box.extend(position);
  return box;
}

}  // namespace

Eigen::Vector3d ChooseOrigin(const TriangleMesh& mesh) {
  constexpr double kNearDiagonals = 16.0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  // Also where its square overflows or vanishes.
  const double diagonal = box.isEmpty() ? 0.0 : box.diagonal().stableNorm();
  if (!(diagonal > 0.0) || !std::isfinite(diagonal)) return origin;
  // A multiple of a power of two near the diagonal: subtracting it from a float of this size
  // leaves a float, so that nothing is rounded that was not before.
  const double step = std::ldexp(1.0, CeilLog2(diagonal));
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
  CCST_ASSIGN_OR_RETURN(result.positions, io::ToFloatPositions(mesh.positions, origin));
  result.faces = mesh.faces;
  result.attributes = mesh.attributes;
  return io::ToStreamLayout(std::move(result));
}

}  // namespace ccst
