#pragma once

#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace ccst::io {

/// Positions relative to `origin`, rounded to 32-bit floats.
/// @errors INVALID_ARGUMENT  MESH_DEGENERATE a coordinate that is no finite float (says which), or
///                           a bounding box so small that floats would flatten it
absl::StatusOr<std::vector<Eigen::Vector3d>> ToFloatPositions(
    const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& origin);

}  // namespace ccst::io
