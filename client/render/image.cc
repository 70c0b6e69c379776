#include "client/render/image.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "absl/status/status.h"

namespace ccst {
namespace {

void Append(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data), size);
}

}  // namespace

absl::StatusOr<std::string> EncodePng(const RgbImage& image) {
  std::string bytes;
  if (stbi_write_png_to_func(&Append, &bytes, image.width, image.height, 3, image.rgb.data(),
                             3 * image.width) == 0) {
    return absl::InternalError("the picture could not be encoded as PNG");
  }
  return bytes;
}

}  // namespace ccst
