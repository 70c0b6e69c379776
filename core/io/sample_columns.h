#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// A column of a sample file, or of the vertices of a mesh file: one component of an attribute.
struct SampleColumn {
  std::string name;  ///< Letters, digits and `_ . -`; unlike every other column's.
  const Attribute* attribute = nullptr;
  std::size_t component = 0;

  bool is_color() const { return attribute->kind == AttributeKind::kColor; }
  /// Of the i-th sample or vertex.
  float Value(std::size_t i) const {
    return attribute->values[i * static_cast<std::size_t>(attribute->components) + component];
  }
};

/// The columns of attributes behind those with the names `taken`: red green blue [alpha] for
/// colours, s t for texture coordinates, its name for a scalar, with `_0`, `_1`... behind it when
/// it has several components. What is taken gets `_2`, `_3`... Attributes by corner are left out.
/// Refer to `attributes`, which must outlive them.
std::vector<SampleColumn> LayOutColumns(const std::vector<Attribute>& attributes,
                                        std::set<std::string> taken);

/// The columns in a binary PLY, colours as uchar, all else as float: the lines of the header, the
/// size of a row, and the i-th row.
void AppendPlyProperties(std::string& out, const std::vector<SampleColumn>& columns);
std::size_t PlyBytes(const std::vector<SampleColumn>& columns);
void AppendPlyValues(std::string& out, const std::vector<SampleColumn>& columns, std::size_t i);

/// A fraction as a byte: 0 for what is no number, clamped otherwise.
std::uint8_t ToByte(float fraction);

}  // namespace ccst::io
