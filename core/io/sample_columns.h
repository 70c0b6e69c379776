#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/io/number_type.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::io {

/// A column of a sample file, or of the vertices of a mesh file: one component of an attribute.
struct SampleColumn {
  std::string name;  ///< Letters, digits and `_ . -`; unlike every other column's.
  const Attribute* attribute = nullptr;
  std::size_t component = 0;

  /// In binary files: colours are bytes, labels are whole, all else is a float.
  NumberType type() const {
    if (attribute->kind == AttributeKind::kColor) return NumberType::kUint8;
    return attribute->kind == AttributeKind::kLabel ? NumberType::kInt32 : NumberType::kFloat;
  }
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

/// Appends what the columns hold of the i-th sample or vertex, each in its type.
void AppendValues(std::string& out, const std::vector<SampleColumn>& columns, std::size_t i);
/// Bytes of such a row.
std::size_t BytesOf(const std::vector<SampleColumn>& columns);
/// The columns' lines in the header of a PLY.
void AppendPlyProperties(std::string& out, const std::vector<SampleColumn>& columns);

/// A label as a whole number: 0 for what is no number, clamped to 32 bits otherwise.
std::int32_t ToWhole(float label);

/// A fraction as a byte: 0 for what is no number, clamped otherwise.
std::uint8_t ToByte(float fraction);

}  // namespace ccst::io
