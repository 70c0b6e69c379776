#pragma once

#include <cstdint>
#include <string_view>

/// Numbers by which files of glTF 2.0 say what they mean, from its specification.
namespace ccst::io::gltf {

// A GLB file's first bytes, and the types of its chunks (4.4).
inline constexpr std::string_view kMagic = "glTF";
inline constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
inline constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"

// `componentType` of an accessor (3.6.2.2).
inline constexpr int kSignedByte = 5120;
inline constexpr int kUnsignedByte = 5121;
inline constexpr int kSignedShort = 5122;
inline constexpr int kUnsignedShort = 5123;
inline constexpr int kUnsignedInt = 5125;
inline constexpr int kFloat = 5126;

// `target` of a view (5.11.5).
inline constexpr int kArrayBuffer = 34962;
inline constexpr int kElementArrayBuffer = 34963;

// `mode` of a primitive (5.24.4); those below 4 are points and lines.
inline constexpr int kPoints = 0;
inline constexpr int kTriangles = 4;
inline constexpr int kTriangleFan = 6;  // 5 is a strip.

}  // namespace ccst::io::gltf
