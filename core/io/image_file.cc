#include "core/io/image_file.h"

#include <cstddef>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <spng.h>
#include <turbojpeg.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"

namespace ccst {
namespace {

absl::Status Unreadable(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kImageUnreadable, message);
}

// Checks what a header announces. Deflate holds at most 1032 bytes in one, and a byte of PNG 8
// pixels; JPEG less. What announces more would only make us take memory.
absl::Status CheckSize(std::int64_t width, std::int64_t height, std::size_t bytes,
                       const ImageLimits& limits) {
  constexpr std::int64_t kMaxPixelsPerByte = 16384;
  const std::int64_t pixels = width * height;
  const std::string size = absl::StrCat(width, " x ", height, " pixels");
  if (pixels <= 0) return Unreadable("the image has no pixels");
  if (pixels > limits.max_pixels) {
    return io::OverLimit(
        absl::StrCat("the image has ", size, "; at most ", limits.max_pixels, " are accepted"));
  }
  if (pixels / kMaxPixelsPerByte > static_cast<std::int64_t>(bytes)) {
    return Unreadable(
        absl::StrCat("the image announces ", size, ", more than its ", bytes, " bytes can hold"));
  }
  return absl::OkStatus();
}

// Channels in [0, 1].
float Grey(double red, double green, double blue, double alpha) {
  const double luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  return static_cast<float>(alpha * luma + (1.0 - alpha));
}

absl::Status OutOfMemory() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                   "there is no memory to decode the image");
}

absl::StatusOr<Image> DecodePng(std::span<const char> bytes, const ImageLimits& limits) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), &spng_ctx_free);
  if (context == nullptr) return OutOfMemory();
  const auto broken = [](int error) {
    return Unreadable(absl::StrCat("the PNG is damaged: ", spng_strerror(error)));
  };
  // Of texts, profiles and the like, which are not looked at.
  constexpr std::size_t kMaxChunk = std::size_t{16} << 20;
  spng_set_chunk_limits(context.get(), kMaxChunk, 2 * kMaxChunk);
  int error = spng_set_png_buffer(context.get(), bytes.data(), bytes.size());
  if (error != SPNG_OK) return broken(error);
  spng_ihdr header = {};
  error = spng_get_ihdr(context.get(), &header);
  if (error != SPNG_OK) return broken(error);
  CCST_RETURN_IF_ERROR(CheckSize(header.width, header.height, bytes.size(), limits));

  constexpr std::size_t kChannels = 4;
  constexpr double kOne = 65535.0;
  const std::size_t pixels = std::size_t{header.width} * header.height;
  std::vector<std::uint16_t> values(kChannels * pixels);
  error = spng_decode_image(context.get(), values.data(), values.size() * sizeof(values[0]),
                            SPNG_FMT_RGBA16, SPNG_DECODE_TRNS);
  if (error != SPNG_OK) return broken(error);
  Image image{.width = static_cast<std::int32_t>(header.width),
              .height = static_cast<std::int32_t>(header.height),
              .values = {}};
  image.values.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint16_t* const value = &values[kChannels * i];
    image.values.push_back(
        Grey(value[0] / kOne, value[1] / kOne, value[2] / kOne, value[3] / kOne));
  }
  return image;
}

absl::StatusOr<Image> DecodeJpeg(std::span<const char> bytes, const ImageLimits& limits) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), &tjDestroy);
  if (decoder == nullptr) return OutOfMemory();
  const auto broken = [&decoder] {
    return Unreadable(absl::StrCat("the JPEG cannot be read: ", tjGetErrorStr2(decoder.get())));
  };
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colors = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling,
                          &colors) != 0) {
    return broken();
  }
  CCST_RETURN_IF_ERROR(CheckSize(width, height, bytes.size(), limits));
  if (colors == TJCS_CMYK || colors == TJCS_YCCK) {
    return Unreadable("the JPEG holds CMYK colours; save it as RGB or grey");
  }

  constexpr std::size_t kChannels = 3;
  constexpr double kOne = 255.0;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<unsigned char> values(kChannels * pixels);
  // A warning is a damaged file, of which the decoder would make up the rest; scans without end
  // are a way to keep it busy.
  constexpr int kFlags = TJFLAG_ACCURATEDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  if (tjDecompress2(decoder.get(), data, bytes.size(), values.data(), width, /*pitch=*/0, height,
                    TJPF_RGB, kFlags) != 0) {
    return broken();
  }
  Image image{.width = width, .height = height, .values = {}};
  image.values.reserve(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const unsigned char* const value = &values[kChannels * i];
    image.values.push_back(Grey(value[0] / kOne, value[1] / kOne, value[2] / kOne, 1.0));
  }
  return image;
}

}  // namespace

absl::StatusOr<Image> DecodeImage(std::span<const char> bytes, const ImageLimits& limits) {
  constexpr std::string_view kPng("\x89PNG\r\n\x1a\n", 8);
  constexpr std::string_view kJpeg("\xff\xd8\xff", 3);
  const std::string_view text(bytes.data(), bytes.size());
  try {
    if (text.starts_with(kPng)) return DecodePng(bytes, limits);
    if (text.starts_with(kJpeg)) return DecodeJpeg(bytes, limits);
  } catch (const std::bad_alloc&) {
    return OutOfMemory();
  }
  return Unreadable("the image is neither a PNG nor a JPEG");
}

}  // namespace ccst
