#pragma once

#include <array>
#include <cstddef>

namespace ccst::io {

/// Kinds of numbers in files of samples and meshes, little-endian where they are binary.
enum class NumberType { kDouble, kFloat, kInt32, kUint8 };

/// What each format calls a kind of number.
struct NumberNames {
  std::size_t bytes = 0;
  const char* ply = "";
  const char* numpy = "";
  const char* vtk = "";
  char pcd = ' ';  ///< Its size stands beside it.
};

inline constexpr std::array<NumberNames, 4> kNumberNames = {{
    {.bytes = 8, .ply = "double", .numpy = "<f8", .vtk = "Float64", .pcd = 'F'},
    {.bytes = 4, .ply = "float", .numpy = "<f4", .vtk = "Float32", .pcd = 'F'},
    {.bytes = 4, .ply = "int", .numpy = "<i4", .vtk = "Int32", .pcd = 'I'},
    {.bytes = 1, .ply = "uchar", .numpy = "|u1", .vtk = "UInt8", .pcd = 'U'},
}};

constexpr const NumberNames& NamesOf(NumberType type) {
  return kNumberNames[static_cast<std::size_t>(type)];
}

}  // namespace ccst::io
