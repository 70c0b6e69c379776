#include "core/io/sample_rows.h"

#include <set>

#include "core/io/numbers.h"
#include "core/io/sample_columns.h"

namespace ccst::io {

std::size_t SampleRows::OffsetOf(std::size_t field) const {
  std::size_t offset = 0;
  for (std::size_t i = 0; i < field; ++i) offset += NamesOf(fields[i].type).bytes;
  return offset;
}

std::string SampleRows::Slice(std::size_t first, std::size_t field_count) const {
  const std::size_t begin = OffsetOf(first);
  const std::size_t size = OffsetOf(first + field_count) - begin;
  std::string slice;
  slice.reserve(size * count());
  for (std::size_t at = begin; at < bytes.size(); at += row_bytes) slice.append(bytes, at, size);
  return slice;
}

std::vector<std::string> OwnFieldNames(const SampleSet& samples) {
  std::vector<std::string> names = {"x", "y", "z", "nx", "ny", "nz", "face", "bary_u", "bary_v"};
  if (!samples.face_corners.empty()) {
    names.insert(names.end(), {"corner_0", "corner_1", "corner_2"});
  }
  return names;
}

SampleRows ToRows(const SampleSet& samples) {
  SampleRows rows;
  const std::vector<std::string> names = OwnFieldNames(samples);
  const auto type_of = [](std::size_t field) {
    if (field < kNormalField) return NumberType::kDouble;
    if (field < kFaceField) return NumberType::kFloat;
    return field >= kBarycentricField && field < kFurtherFields ? NumberType::kDouble
                                                                : NumberType::kInt32;
  };
  for (std::size_t i = 0; i < names.size(); ++i) rows.fields.push_back({names[i], type_of(i)});
  const std::vector<SampleColumn> columns =
      LayOutColumns(samples.attributes, std::set<std::string>(names.begin(), names.end()));
  for (const SampleColumn& column : columns) rows.fields.push_back({column.name, column.type()});
  rows.row_bytes = rows.OffsetOf(rows.fields.size());
  constexpr std::size_t kHeaderBytes = 4096;  // Room for what files have in front of the rows.
  rows.bytes.reserve(kHeaderBytes + rows.row_bytes * samples.positions.size());
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    for (const double value : samples.positions[i]) AppendLittleEndian(rows.bytes, value);
    for (const double value : samples.normals[i]) {
      AppendLittleEndian(rows.bytes, static_cast<float>(value));
    }
    AppendLittleEndian(rows.bytes, samples.faces[i]);
    for (const double value : samples.barycentrics[i]) AppendLittleEndian(rows.bytes, value);
    if (!samples.face_corners.empty()) {
      for (const int corner : samples.face_corners[i]) AppendLittleEndian(rows.bytes, corner);
    }
    AppendValues(rows.bytes, columns, i);
  }
  return rows;
}

}  // namespace ccst::io
