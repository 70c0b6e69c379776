#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "core/io/mesh_file.h"

namespace ccst::io {

/// What the vertices of an OFF file have besides x y z, as its keyword says, in the order in which
/// the numbers follow each other.
struct OffVertexValues {
  bool has_normal = false;
  bool has_color = false;
  bool has_texture = false;
};

/// The records of a binary OFF file. Its definition has big-endian numbers and behind every face
/// the numbers of a colour; common programs write the order of their machine and no colours. Of
/// these four the one is taken that fits the length of `bytes`. Attributes are as those of text.
/// @param bytes  what follows the line with the keyword
/// @errors INVALID_ARGUMENT  MESH_UNREADABLE | MESH_DEGENERATE | LIMIT_EXCEEDED
absl::StatusOr<MeshFile> ReadBinaryOff(std::string_view bytes, const OffVertexValues& values,
                                       const MeshLimits& limits);

}  // namespace ccst::io
