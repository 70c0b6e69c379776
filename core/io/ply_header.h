#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace ccst::io {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// Bytes of a binary value.
std::size_t PlyTypeSize(PlyType type);
bool PlyTypeIsInteger(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;  ///< Of the value, or of the items of a list.
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< Lists only; an integer.
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool ascii = false;
  std::endian order = std::endian::little;  ///< Binary files only.
  std::vector<PlyElement> elements;
  std::size_t data_offset = 0;  ///< Where the first element starts.
  std::int64_t data_line = 0;   ///< The line that is on, counted from 1.
};

/// Reads up to and including `end_header`. Counts are as announced, not compared with anything.
/// @errors INVALID_ARGUMENT MESH_UNREADABLE, with the line
absl::StatusOr<PlyHeader> ReadPlyHeader(std::string_view bytes);

}  // namespace ccst::io
