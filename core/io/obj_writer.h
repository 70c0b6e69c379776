#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// The text of an OBJ file, whose numbers round-trip. Of the attributes by vertex it has places for
/// two: the first colours, without alpha, behind the coordinates (`v x y z r g b`), and the first
/// texture coordinates, as many `vt` as `v`, which the faces refer to (`f 1/1 2/2 3/3`).
/// @param faces  indices must be in range; without any the file holds points
std::string EncodeObj(const std::vector<Eigen::Vector3d>& positions,
                      const std::vector<Eigen::Vector3i>& faces,
                      const std::vector<Attribute>& attributes);

}  // namespace ccst::io
