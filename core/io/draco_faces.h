#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draco/mesh/mesh.h"

namespace ccst::io {

/// Puts into the metadata which face of its file each triangle was cut from, see DracoFaceSource().
/// Nothing where that is plain: an empty `face_source`, or one that does not ascend.
void AddFaceSource(std::span<const std::int32_t> face_source, draco::Mesh& mesh);

}  // namespace ccst::io
