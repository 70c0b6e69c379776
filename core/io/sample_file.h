#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst {

/// Formats of sample files. Records are in the order of the samples. Attributes: PLY and CSV hold
/// colours as red green blue [alpha] (PLY: uchar; CSV: fractions), texture coordinates as s t,
/// scalars by name (PLY: float); see LayOutColumns() for names that are not plain or taken. OBJ
/// holds the first colours and texture coordinates, see EncodeObj(), Draco all, see
/// EncodeDracoCloud().
enum class SampleFormat {
  kPly,    ///< Binary little endian: double x y z, float nx ny nz, int face, double bary_u bary_v;
           ///< int corner_0 corner_1 corner_2 where there are face corners.
  kCsv,    ///< The same columns with a header line; text round-trips doubles and floats.
  kXyz,    ///< `x y z` a line; text round-trips the doubles.
  kObj,    ///< `v x y z [r g b]` a line, then `vt s t`; text round-trips the doubles.
  kDraco,  ///< A point cloud of 32-bit floats, positions and normals, in order.
  kNpy,    ///< NumPy's structured array with the columns of PLY, see EncodeNpy().
  kNpz,    ///< NumPy's arrays, triangles among them, see EncodeNpz().
  kPcd,    ///< Binary PCD with coordinates as 32-bit floats, see EncodePcd().
  kVtp,    ///< VTK's PolyData with the triangles, see EncodeVtp().
};

/// Extensions of SampleFormat, as messages and help name them.
inline constexpr char kSampleExtensions[] = ".ply .csv .xyz .obj .drc .npy .npz .pcd .vtp";

/// Format by the path's extension, in any case; empty when it is none of kSampleExtensions.
std::optional<SampleFormat> SampleFormatFromPath(std::string_view path);

/// The bytes of a sample file. Cost O(n).
/// @errors INVALID_ARGUMENT  arrays of unequal length; for Draco no samples, for Draco and PCD a
///                           position that is no finite float
///         RESOURCE_EXHAUSTED  OUT_OF_MEMORY for .npz
absl::StatusOr<std::string> EncodeSamples(const SampleSet& samples, SampleFormat format);

/// Writes the samples, atomically (see WriteFileAtomically), in `format` or, without one, in
/// that of the path's extension. The path `-` is standard output and needs a format.
/// @errors those of EncodeSamples and WriteFileAtomically, and INVALID_ARGUMENT for an extension
///         that names no format
absl::Status WriteSamplesFile(const SampleSet& samples, const std::string& path,
                              std::optional<SampleFormat> format = std::nullopt);

/// Reads samples, also those of other programs: .ply .obj .off .stl .glb .gltf and Draco meshes,
/// whose faces are the sample mesh where there are any; .xyz, three numbers a line and what follows
/// them passed over; .csv with columns x, y and z. Lines that start with # are comments.
/// @return n positions [mesh unit], finite, n > 0; m triangles or none.
/// @errors those of ReadMeshFile(); for .xyz and .csv INVALID_ARGUMENT MESH_UNREADABLE | MESH_EMPTY
///         naming path and line
absl::StatusOr<TriangleMesh> ReadSamplesFile(const std::string& path);

}  // namespace ccst
