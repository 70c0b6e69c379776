#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// A Draco point cloud in the order given, not quantised. Attributes go with it as EncodeDraco()
/// writes them: colours as COLOR, texture coordinates as TEX_COORD, all else as GENERIC, 32-bit
/// floats with the metadata entry `name`.
/// @param positions   n x 3, finite as 32-bit floats; 1 to 2^31 - 1 of them
/// @param normals     n x 3; empty for none
/// @param attributes  n rows each
absl::StatusOr<std::string> EncodeDracoCloud(const std::vector<Eigen::Vector3d>& positions,
                                             const std::vector<Eigen::Vector3d>& normals,
                                             const std::vector<Attribute>& attributes);

}  // namespace ccst::io
