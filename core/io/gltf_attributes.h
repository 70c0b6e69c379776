#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// What the values under a key of a primitive's `attributes` are: COLOR_0 and so on colours,
/// TEXCOORD_0 and so on texture coordinates, `_NAME` anything. Empty for all others, among them
/// POSITION and NORMAL.
std::optional<AttributeKind> KindOfGltfAttribute(std::string_view key);

/// Refuses attributes of more than kMaxAttributes, or of more than `max_bytes`, before they are
/// read: many keys may share their numbers, so that the file's size bounds nothing.
/// @param width  numbers of a row, of all attributes together
absl::Status CheckGltfAttributes(std::size_t attributes, std::size_t width, std::size_t rows,
                                 std::int64_t max_bytes);

/// Puts the attributes of a file's primitives together, by corner, because Draco has some by
/// corner. White, (0, 0) or zeros where a primitive has none.
class GltfAttributes {
 public:
  /// @param max_bytes  that all values together may take
  explicit GltfAttributes(std::int64_t max_bytes) : max_bytes_(max_bytes) {}

  /// Adds the attributes of `part`, whose names are their keys; the sizes must be right.
  /// @param order   in which the corners of each face follow each other
  /// @param before  corners of the parts before
  /// @param ignored attributes that were passed over, counted by a text for people: their
  ///                components are not those of their kind, or other ones than in a part before
  /// @errors INVALID_ARGUMENT  LIMIT_EXCEEDED
  absl::Status Append(const TriangleMesh& part, const std::array<int, 3>& order, std::size_t before,
                      std::map<std::string, std::int64_t>& ignored);

  /// The attributes in the order of their keys: colours, texture coordinates turned to count v from
  /// below, then the others, named without the underscore.
  /// @param corners  of the whole mesh
  std::vector<Attribute> Finish(std::size_t corners) &&;

 private:
  absl::Status Check(const Attribute& attribute, std::size_t corners) const;

  std::int64_t max_bytes_;
  std::map<std::string, Attribute> by_key_;  // Values up to the last primitive that has some.
};

}  // namespace ccst::io
