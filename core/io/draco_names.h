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

/// The metadata entry of the mesh that tells which corners of their face triangles have: three
/// varints for each triangle of a face that was cut into several. Only where one is no fan.
inline constexpr char kDracoCornersEntry[] = "ccst.corners";

/// The metadata entry of an attribute that tells what its values are where Draco's own type does
/// not: kDracoLabelKind for labels, which are stored as floats.
inline constexpr char kDracoKindEntry[] = "ccst.kind";
inline constexpr char kDracoLabelKind[] = "label";

}  // namespace ccst::io
