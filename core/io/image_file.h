#pragma once

#include <cstdint>
#include <span>

#include "absl/status/statusor.h"
#include "core/density/image.h"

namespace ccst {

/// What DecodeImage() accepts, checked against the announced size before memory is taken.
struct ImageLimits {
  std::int64_t max_pixels = std::int64_t{1} << 25;  ///< 8192 x 4096.
};

/// Decodes a PNG or a JPEG, told apart by their first bytes, to grey: 0.2126 R + 0.7152 G +
/// 0.0722 B (Rec. 709) of the values as they are stored, usually sRGB, with no gamma undone;
/// transparent pixels as they look on white. 0 is black, 1 is white. All of PNG's depths, palettes
/// and interlacing; baseline and progressive JPEG, grey or YCbCr.
///
/// A damaged or truncated file is refused. Cost O(pixels), memory up to 16 bytes a pixel.
/// @errors INVALID_ARGUMENT  IMAGE_UNREADABLE (says why); LIMIT_EXCEEDED more pixels than accepted
///         RESOURCE_EXHAUSTED OUT_OF_MEMORY
absl::StatusOr<Image> DecodeImage(std::span<const char> bytes, const ImageLimits& limits = {});

}  // namespace ccst
