#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst {

/// Decodes a Draco mesh, bitstream 1.1 to 2.2, sequential or Edgebreaker. The announced counts
/// are checked against `limits`, and against what the bytes could possibly hold, before the
/// decoder is started, so that a small file cannot make it allocate much.
/// @return the values of the position attribute, in its order, and the faces in the decoder's
///         order; indices in range, coordinates finite, at least one face. Attributes: colours,
///         texture coordinates and generic ones of up to four components, as floats, named by their
///         metadata entry `name` (else `attribute_ID`) and with their unique ids; by corner where
///         the corners of a vertex differ. Normals are passed over.
/// @errors INVALID_ARGUMENT  DRACO_DECODE_FAILED (says what and at which byte; point clouds are
///                           named as such), MESH_EMPTY, MESH_DEGENERATE, LIMIT_EXCEEDED
absl::StatusOr<TriangleMesh> DecodeDraco(std::span<const char> bytes,
                                         const MeshLimits& limits = {});

/// Encodes positions and faces so that decoding gives back every face and every vertex in its
/// place (sequential encoding). Without quantisation positions are exactly the 32-bit floats
/// nearest to the doubles given. Attributes go with it, never quantised: colours as COLOR, texture
/// coordinates as TEX_COORD, scalars as GENERIC, with the metadata entry `name`; their unique ids
/// are 1, 2, ... Vertices whose corners differ become several points; a generic attribute
/// `ccst.splits` lets DecodeDraco() put them together again.
///
/// Decoders refuse more points than corners: when there are more, vertices of no face are left
/// out, and the others keep their order.
/// @param quantization_bits  bits per coordinate of the bounding box's longest side, in [1, 24]
/// @errors INVALID_ARGUMENT  MESH_EMPTY no face; MESH_DEGENERATE an index out of range, a
///                           coordinate that is no finite float, an attribute of the wrong
///                           size; OPTION_INVALID bits out of range
/// @param face_source   kept for DracoFaceSource(): F ascending numbers as in MeshFile, or empty
/// @param face_corners  kept for DracoFaceCorners(): F x 3 as in MeshFile, or empty
absl::StatusOr<std::string> EncodeDraco(const TriangleMesh& mesh,
                                        std::optional<int> quantization_bits = std::nullopt,
                                        std::span<const std::int32_t> face_source = {},
                                        std::span<const Eigen::Vector3i> face_corners = {});

/// The `face_source` that a stream of EncodeDraco() carries, empty without one: F numbers that
/// ascend. Reads the metadata alone, and trusts the announced counts: for streams that
/// DecodeDraco() has taken.
/// @errors INVALID_ARGUMENT  DRACO_DECODE_FAILED
absl::StatusOr<std::vector<std::int32_t>> DracoFaceSource(std::span<const char> bytes);

/// The `face_corners` that a stream of EncodeDraco() carries, F x 3, each below the corners of its
/// face; empty without them. As DracoFaceSource().
/// @errors INVALID_ARGUMENT  DRACO_DECODE_FAILED
absl::StatusOr<std::vector<Eigen::Vector3i>> DracoFaceCorners(std::span<const char> bytes);

/// Where to put the origin so that 32-bit floats lose little: zero when every coordinate is
/// within 16 diagonals of the bounding box from it, which leaves ordinary meshes as they are;
/// else the box's centre, rounded to few enough bits that subtracting it is exact for
/// coordinates that are floats themselves. Zero for an empty or non-finite mesh.
Eigen::Vector3d ChooseOrigin(const TriangleMesh& mesh);

/// The mesh that DecodeDraco returns for EncodeDraco(`mesh` moved by -`origin`): positions
/// relative to `origin`, rounded to 32-bit floats; the same faces in the same order; attributes
/// with the names and ids they travel by, and by vertex wherever the corners of each vertex agree.
/// What a run computes on. Indices must be in range.
/// @errors INVALID_ARGUMENT  MESH_DEGENERATE a coordinate that is no finite float (says which),
///                           a mesh so small that floats would flatten it, or an attribute of
///                           the wrong size
absl::StatusOr<TriangleMesh> ToWirePrecision(const TriangleMesh& mesh,
                                             const Eigen::Vector3d& origin);

}  // namespace ccst
