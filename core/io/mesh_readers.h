#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "core/io/mesh_file.h"

namespace ccst::io {

// One reader a format, each in the file of its name. See ReadMesh for what they promise.

/// Wavefront OBJ: `v` and `f` statements, negative indices, joined lines; others are passed over.
absl::StatusOr<MeshFile> ReadObj(std::string_view text, const MeshLimits& limits);

/// PLY 1.0: ascii and both binary byte orders; elements and properties that are not x, y, z or
/// vertex_indices (vertex_index) are passed over.
absl::StatusOr<MeshFile> ReadPly(std::string_view bytes, const MeshLimits& limits);

/// STL, ascii or binary, told apart by the size that a binary file's count asks for.
absl::StatusOr<MeshFile> ReadStl(std::string_view bytes, const MeshLimits& limits);

/// OFF with its COFF, NOFF, STOFF variants; what follows x y z or the corners on a line is
/// passed over.
absl::StatusOr<MeshFile> ReadOff(std::string_view text, const MeshLimits& limits);

}  // namespace ccst::io
