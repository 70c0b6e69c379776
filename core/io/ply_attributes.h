#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/ply_header.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// What the values of one property of a vertex or a face are.
struct PlyColumn {
  enum class Use { kNone, kPosition, kAttribute };
  Use use = Use::kNone;
  std::size_t attribute = 0;  ///< Attributes only.
  int component = 0;          ///< Of the position or the attribute.
  double divisor = 1.0;       ///< Values of the file are this many times ours.
};

struct PlyLayout {
  std::vector<PlyColumn> columns;     ///< One a property.
  std::vector<Attribute> attributes;  ///< Without values.
};

/// Finds positions (x y z) and attributes among the properties of the vertices:
/// - colours: red green blue [alpha], also with `diffuse_` in front; bytes and 16-bit numbers are
///   scaled to [0, 1], floats taken as they are;
/// - texture coordinates: s t, u v, or texture_u texture_v;
/// - every other number but the normals nx ny nz as an attribute of its name: integers as labels,
///   floats as scalars.
/// Lists are passed over.
/// @errors INVALID_ARGUMENT MESH_UNREADABLE no position; LIMIT_EXCEEDED more attributes than
///         kMaxAttributes
absl::StatusOr<PlyLayout> LayOutPlyVertices(const PlyElement& element);

/// Finds attributes among the properties of the faces, as LayOutPlyVertices() does; they are by
/// corner, since every corner of a face has its values.
/// @param taken  attributes that the vertices have
/// @errors INVALID_ARGUMENT LIMIT_EXCEEDED more attributes than kMaxAttributes, `taken` included
absl::StatusOr<PlyLayout> LayOutPlyFaces(const PlyElement& element, std::size_t taken);

/// The list of the corners of a face or of a strip of triangles.
bool IsPlyCornerList(const PlyProperty& property);

/// The list of a face's texture coordinates, two a corner.
bool IsPlyTextureList(const PlyProperty& property);

}  // namespace ccst::io
