#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/io/mesh_file.h"

namespace ccst::io {

// One reader a format, each in the file of its name. See ReadMesh for what they promise.

/// Wavefront OBJ: `v`, `vt` and `f` statements, negative indices, joined lines; others are passed
/// over. Attributes: the colours of `v x y z r g b`, taken for bytes when one is above 1 (white
/// where a vertex has none), and texture
/// coordinates by corner ((0, 0) where a corner has none).
absl::StatusOr<MeshFile> ReadObj(std::string_view text, const MeshLimits& limits);

/// PLY 1.0: ascii and both binary byte orders; positions x, y, z, faces vertex_indices
/// (vertex_index) and strips of triangles. Attributes: those of LayOutPlyVertices() and
/// LayOutPlyFaces(), and texture coordinates by corner from
/// the faces' lists `texcoord` ((0, 0) where a face has none). All else is passed over.
absl::StatusOr<MeshFile> ReadPly(std::string_view bytes, const MeshLimits& limits);

/// STL, ascii or binary, told apart by the size that a binary file's count asks for. A count of 0
/// with facets behind it means all of them; text needs no `endsolid`.
absl::StatusOr<MeshFile> ReadStl(std::string_view bytes, const MeshLimits& limits);

/// OFF, text or binary (ReadBinaryOff()), with its variants: any of ST, C and N, in this order,
/// before OFF. Attributes of vertices, in the order in which the numbers follow x y z: normals (N),
/// which are passed over, colours (C), three or four numbers, taken for bytes when one is above 1,
/// texture coordinates (ST). White and (0, 0) where a vertex has none. What else follows on a line,
/// as the colours of faces, is passed over.
absl::StatusOr<MeshFile> ReadOff(std::string_view text, const MeshLimits& limits);

/// glTF 2.0, binary or JSON: the triangles, strips and fans of the meshes of ReadGltfScene(), with
/// the transforms of their nodes, in scene order; faces are counted through over all primitives.
/// Attributes, by corner: the colours COLOR_0 (white where a primitive has none) and texture
/// coordinates TEXCOORD_0, turned to count v from below. Primitives may be compressed with Draco,
/// buffers with meshoptimizer.
/// @param folder  of the file, see GltfDocument::Open
absl::StatusOr<MeshFile> ReadGltf(std::string_view bytes, const MeshLimits& limits,
                                  const std::optional<std::string>& folder);

}  // namespace ccst::io
