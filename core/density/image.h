#pragma once

#include <cstdint>
#include <vector>

namespace ccst {

/// A grey image: the values of its pixels, row by row from the top.
struct Image {
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::vector<float> values;  ///< width * height, row major.
};

}  // namespace ccst
