#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace ccst {

/// What the values of an attribute are, for those who write or show them.
enum class AttributeKind : std::uint8_t {
  kScalar,              ///< Anything: a quality, a temperature, a density.
  kColor,               ///< Red, green, blue and maybe alpha in [0, 1].
  kTextureCoordinates,  ///< u, v; (0, 0) is the lower left corner of the image.
  kLabel,               ///< Whole numbers that name something, of which no average makes sense.
};

/// Values carried by the vertices or the corners of a mesh, or by samples.
struct Attribute {
  std::string name;  ///< Unique in its mesh; see NameAttributes().
  AttributeKind kind = AttributeKind::kScalar;
  int components = 1;  ///< K in [1, 4].
  /// Three rows a face instead of one a vertex. In between, labels are those of the nearest corner,
  /// all else is linear.
  bool per_corner = false;
  std::vector<float> values = {};  ///< Row major: V x K or 3 F x K; n x K for samples.
  std::int32_t id = -1;            ///< Draco's unique id, where a Draco stream gave one.
};

/// A plain indexed triangle list, as read from a file or a stream. No invariant holds beyond
/// the types: indices may be out of range and coordinates non-finite until
/// `Repair` (core/repair) has checked them.
struct TriangleMesh {
  /// V x 3 [mesh unit].
  std::vector<Eigen::Vector3d> positions;
  /// F x 3 indices into `positions`; counter-clockwise seen from outside.
  std::vector<Eigen::Vector3i> faces;
  /// In the file's order; may be empty.
  std::vector<Attribute> attributes = {};
};

}  // namespace ccst
