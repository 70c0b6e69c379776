#include "core/io/float_positions.h"

#include <cstddef>
#include <limits>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"

namespace ccst::io {

absl::StatusOr<std::vector<Eigen::Vector3d>> ToFloatPositions(
    const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& origin) {
  std::vector<Eigen::Vector3d> result;
  result.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Eigen::Vector3d position = positions[i] - origin;
    for (double& coordinate : position) coordinate = RoundedToFloat(coordinate);
    if (!position.allFinite()) {
      return Degenerate(absl::StrCat(
          "vertex ", i, " (counted from 0) has a coordinate that is no finite 32-bit float (at ",
          "most 3.4e38); scale the mesh down"));
    }
    result.push_back(position);
  }
  // Below the smallest normal float the grid of floats is as coarse as the mesh.
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : positions) box.extend(position);
  const double diagonal = box.isEmpty() ? 0.0 : box.diagonal().stableNorm();
  if (diagonal > 0.0 && diagonal < static_cast<double>(std::numeric_limits<float>::min())) {
    return Degenerate(absl::StrCat("the bounding box's diagonal is ", diagonal,
                                   "; 32-bit floats need at least 1.2e-38; scale the mesh up"));
  }
  return result;
}

}  // namespace ccst::io
