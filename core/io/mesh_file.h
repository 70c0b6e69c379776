#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst {

/// Formats that can be read.
enum class MeshFormat { kObj, kPly, kStl, kOff, kGltf, kDraco };

/// Formats that can be written; glTF as binary.
enum class MeshOutputFormat { kObj, kPly, kStl, kOff, kDraco, kGlb };

/// What a reader did not take from a file as it stood. Nothing of it keeps a mesh from being read.
struct ReadReport {
  std::int64_t faces_skipped = 0;           ///< Faces with fewer than three corners.
  std::int64_t polygons_self_crossing = 0;  ///< Cut as well as could be.
  std::int64_t vertices_not_finite = 0;     ///< No face uses them; they lie at one that is used.
  std::vector<std::string> ignored = {};    ///< For people, for example "2 morph targets".
};

/// A mesh as a file holds it. Every index of `mesh` is in range and every coordinate finite;
/// there is at least one face. Nothing else is checked.
struct MeshFile {
  /// V x 3 positions, F x 3 indices. Vertices keep the file's order; polygons are cut into
  /// triangles (PolygonCutter) in the file's order. Vertices of STL, which shares none, are those
  /// with bitwise equal coordinates, in order of first use.
  TriangleMesh mesh;
  /// F: the file's own face each triangle was cut from. Empty when triangle i is face i.
  std::vector<std::int32_t> face_source;
  /// F x 3: which corners of its face, counted from 0, each triangle has. Empty when all faces are
  /// cut as fans: the i-th triangle of each then has the corners 0, i + 1 and i + 2.
  std::vector<Eigen::Vector3i> face_corners = {};
  ReadReport report = {};
};

/// Format by the path's extension, in any case; empty when it is none of .obj .ply .stl .off
/// .glb .gltf .drc, each of which may have .gz behind it.
std::optional<MeshFormat> MeshFormatFromPath(std::string_view path);

/// Format by the path's extension, in any case; empty when it is none of .obj .ply .stl .off
/// .drc .glb.
std::optional<MeshOutputFormat> MeshOutputFormatFromPath(std::string_view path);

/// Parses a whole file, or one compressed by gzip; of glTF, one that needs no other files. Numbers
/// do not depend on the locale. Cost O(bytes), memory bounded by a constant times the bytes given,
/// once they are decompressed, which gives at most `limits.max_bytes` (for Draco see DecodeDraco).
/// @errors INVALID_ARGUMENT  MESH_UNREADABLE | DRACO_DECODE_FAILED (says the line or the byte),
///                           MESH_EMPTY (no face), MESH_DEGENERATE (names the first index out of
///                           range or coordinate that is not finite), LIMIT_EXCEEDED
absl::StatusOr<MeshFile> ReadMesh(std::string_view bytes, MeshFormat format,
                                  const MeshLimits& limits = {});

/// Reads `path` in the format of its extension, and the .bin files beside it that a .gltf names.
/// @errors those of ReadMesh with the path in front, and
///         NOT_FOUND | PERMISSION_DENIED | UNKNOWN the file cannot be read (says why)
///         INVALID_ARGUMENT  MESH_UNREADABLE the extension names no format that can be read
absl::StatusOr<MeshFile> ReadMeshFile(const std::string& path, const MeshLimits& limits = {});

/// The bytes of a file in `format`. Text formats round-trip the doubles; PLY (binary) and OFF
/// hold doubles too; STL (binary), GLB and Draco hold 32-bit floats. Faces keep their order.
///
/// Attributes go with it where the format has a place for them: all in Draco and GLB
/// (EncodeDraco(), EncodeGlb()); those by vertex in PLY, colours as uchar and all else as float,
/// see LayOutColumns(); the first colours and texture coordinates by vertex in OBJ (EncodeObj());
/// none in OFF and STL. Without faces the file holds points, but in STL, which then holds nothing.
/// Cost O(V + F); O(F log F) for attributes by corner in Draco and GLB.
/// @errors INVALID_ARGUMENT  MESH_DEGENERATE an index is out of range, an attribute has the
///                           wrong size, or a coordinate is not finite in the format's precision;
///                           MESH_EMPTY Draco or GLB without vertices; LIMIT_EXCEEDED more than the
///                           format can count
absl::StatusOr<std::string> EncodeMesh(const TriangleMesh& mesh, MeshOutputFormat format);

/// Writes the format of the path's extension, atomically (see WriteFileAtomically).
/// @errors those of EncodeMesh and WriteFileAtomically, and INVALID_ARGUMENT for an extension
///         that names no format that can be written
absl::Status WriteMeshFile(const TriangleMesh& mesh, const std::string& path);

}  // namespace ccst
