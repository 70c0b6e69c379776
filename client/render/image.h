#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace ccst {

/// A picture: height x width x 3 bytes (sRGB), rows from the top.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  /// Three bytes of the pixel in column `x`, row `y`; both in range.
  const std::uint8_t* Pixel(int x, int y) const {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  }
};

/// The bytes of a PNG file holding `image`. INTERNAL when it cannot be encoded.
absl::StatusOr<std::string> EncodePng(const RgbImage& image);

}  // namespace ccst
