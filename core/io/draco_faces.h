#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "draco/mesh/mesh.h"

namespace ccst::io {

/// Puts into the metadata which face of its file each triangle was cut from, see DracoFaceSource().
/// Nothing where that is plain: an empty `face_source`, or one that does not ascend.
void AddFaceSource(std::span<const std::int32_t> face_source, draco::Mesh& mesh);

/// Puts into the metadata which corners of its face each triangle has, see DracoFaceCorners().
/// Nothing where `face_corners` is empty or the faces are not told.
void AddFaceCorners(std::span<const std::int32_t> face_source,
                    std::span<const Eigen::Vector3i> face_corners, draco::Mesh& mesh);

}  // namespace ccst::io
