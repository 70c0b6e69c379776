#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/io/number_type.h"
#include "core/sampling/result.h"

namespace ccst::io {

/// A number of each sample.
struct RowField {
  std::string name;  ///< Letters, digits and `_ . -`; unlike every other field's.
  NumberType type = NumberType::kFloat;
};

/// Samples as a table: one row of little-endian numbers without gaps for each.
struct SampleRows {
  std::vector<RowField> fields;
  std::size_t row_bytes = 0;
  std::string bytes;

  std::size_t count() const { return row_bytes == 0 ? 0 : bytes.size() / row_bytes; }
  /// Where a field begins in its row [byte].
  std::size_t OffsetOf(std::size_t field) const;
  /// The fields [first, first + fields) of all rows, one row after the other.
  std::string Slice(std::size_t first, std::size_t fields) const;
};

/// The fields that every sample has come first, in this order.
enum StandardField : std::size_t {
  kPositionField = 0,     ///< x y z, doubles.
  kNormalField = 3,       ///< nx ny nz, floats.
  kFaceField = 6,         ///< face, a 32-bit number.
  kBarycentricField = 7,  ///< bary_u bary_v, doubles.
  kFurtherFields = 9,     ///< corner_0 corner_1 corner_2 where faces are polygons, then attributes.
};

/// The table of `samples`, whose arrays must be of equal lengths: the standard fields; corner_0
/// corner_1 corner_2 where there are face corners; attributes as LayOutColumns() names them,
/// colours as bytes, labels as 32-bit numbers, all else as floats. Cost O(n) in time and memory.
SampleRows ToRows(const SampleSet& samples);

/// Names of the fields of ToRows() that are not attributes.
std::vector<std::string> OwnFieldNames(const SampleSet& samples);

}  // namespace ccst::io
