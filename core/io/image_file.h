#pragma once

#include <cstdint>
#include <span>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/io/byte_source.h"

namespace ccst {

/// What DecodeImage() accepts, checked against the announced size before memory is taken.
struct ImageLimits {
  std::int64_t max_pixels = std::int64_t{1} << 25;  ///< 8192 x 4096.
};

/// What an image says of itself before it is decoded.
struct ImageFacts {
  std::int64_t width = 0;
  std::int64_t height = 0;
  /// What DecodeImage() may take at its peak, the image included.
  std::int64_t decode_bytes = 0;
};

/// Reads the header of a PNG or a JPEG, and checks it as DecodeImage() does. Of a JPEG it passes
/// over what stands before its first scan.
/// @errors INVALID_ARGUMENT  IMAGE_UNREADABLE it is neither, or does not say its size;
///                           LIMIT_EXCEEDED | those of `source`
absl::StatusOr<ImageFacts> ReadImageFacts(const ByteSource& source, const ImageLimits& limits = {});

/// Decodes a PNG or a JPEG, told apart by their first bytes, to grey: 0.2126 R + 0.7152 G +
/// 0.0722 B (Rec. 709) of the values as they are stored, usually sRGB, with no gamma undone;
/// transparent pixels as they look on white. 0 is black, 1 is white. All of PNG's depths, palettes
/// and interlacing; baseline and progressive JPEG, grey or YCbCr.
///
/// A damaged or truncated file is refused. Cost O(pixels), memory as ReadImageFacts() says: 4 bytes
/// a pixel and a row for a PNG, 12 for an interlaced one; 7 a pixel for a JPEG of one scan, up to
/// 13 for one of several.
/// @errors INVALID_ARGUMENT  IMAGE_UNREADABLE (says why); LIMIT_EXCEEDED more pixels than accepted
///         RESOURCE_EXHAUSTED OUT_OF_MEMORY
absl::StatusOr<Image> DecodeImage(std::span<const char> bytes, const ImageLimits& limits = {});

}  // namespace ccst
