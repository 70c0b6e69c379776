#pragma once

namespace ccst::io {

/// The metadata entry that names an attribute, as other programs write it too.
inline constexpr char kDracoNameEntry[] = "name";

/// The name of the attribute of our own that tells which points are one vertex: 8-bit numbers, 1
/// where a point is the same vertex as the point before. Only in streams whose vertices have
/// corners with different values.
inline constexpr char kDracoSplitsName[] = "ccst.splits";

/// The metadata entry of the mesh that tells which face of its file each triangle was cut from:
/// runs of three varints, see draco_faces.cc. Only in streams of meshes with polygons.
inline constexpr char kDracoFacesEntry[] = "ccst.faces";

}  // namespace ccst::io
