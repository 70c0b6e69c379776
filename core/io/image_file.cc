#include "core/io/image_file.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <spng.h>
#include <turbojpeg.h>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "core/io/byte_reader.h"
#include "core/io/numbers.h"

namespace ccst {
namespace {

absl::Status Unreadable(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kImageUnreadable, message);
}

// Checks what a header announces. Deflate holds at most 1032 bytes in one, and a byte of PNG 8
// pixels; JPEG less. What announces more would only make us take memory.
absl::Status CheckSize(std::int64_t width, std::int64_t height, std::int64_t bytes,
                       const ImageLimits& limits) {
  constexpr std::int64_t kMaxPixelsPerByte = 16384;
  const std::string size = absl::StrCat(width, " x ", height, " pixels");
  if (width <= 0 || height <= 0) return Unreadable("the image has no pixels");
  // Sides have 31 bits.
  const std::int64_t pixels = width * height;
  if (pixels > limits.max_pixels) {
    return OverLimit(
        {"max_texture_pixels", limits.max_pixels, pixels},
        absl::StrCat("the image has ", size, "; at most ", limits.max_pixels, " are accepted"));
  }
  if (pixels / kMaxPixelsPerByte > bytes) {
    return Unreadable(
        absl::StrCat("the image announces ", size, ", more than its ", bytes, " bytes can hold"));
  }
  return absl::OkStatus();
}

// Most significant byte first.
template <typename T>
T BigEndian(io::ByteReader& reader) {
  const T value = reader.Fixed<T>();
  return io::LoadBytes<T>(reinterpret_cast<const char*>(&value), std::endian::big);
}

// Of grey values as they are returned.
constexpr std::int64_t kGreyBytes = sizeof(float);
// Of four channels of 16 bits, which libspng makes of everything.
constexpr std::int64_t kRgba16Bytes = 8;

// Behind the mark.
absl::StatusOr<ImageFacts> PngFacts(io::ByteReader& reader) {
  constexpr std::uint32_t kHeader = 0x49484452;  // "IHDR"
  reader.Skip(4);                                // Its length.
  const bool is_header = BigEndian<std::uint32_t>(reader) == kHeader;
  ImageFacts facts{.width = BigEndian<std::uint32_t>(reader),
                   .height = BigEndian<std::uint32_t>(reader)};
  reader.Skip(4);  // Depth, kind of colour, compression, filter.
  const bool is_interlaced = reader.Fixed<std::uint8_t>() != 0;
  if (reader.failed() || !is_header || facts.width > INT32_MAX || facts.height > INT32_MAX) {
    return Unreadable("the PNG is damaged: it does not begin with its header");
  }
  const std::int64_t pixels = facts.width * facts.height;
  facts.decode_bytes = is_interlaced ? (kGreyBytes + kRgba16Bytes) * pixels
                                     : kGreyBytes * pixels + 2 * kRgba16Bytes * facts.width;
  return facts;
}

// What a frame of a JPEG says of itself.
struct JpegFrame {
  std::int64_t width = 0;
  std::int64_t height = 0;
  int components = 0;
  bool is_progressive = false;
  double coefficients = 0.0;  // For each pixel; colours may be coarser than brightness.
};

JpegFrame ReadFrame(io::ByteReader& reader, int mark) {
  constexpr int kBaseline = 0xc1;  // The frames of up to here may come in one scan.
  reader.Skip(3);                  // Length and depth.
  JpegFrame frame{.is_progressive = mark > kBaseline};
  frame.height = BigEndian<std::uint16_t>(reader);
  frame.width = BigEndian<std::uint16_t>(reader);
  frame.components = reader.Fixed<std::uint8_t>();
  int sum = 0;
  int most_across = 1;
  int most_down = 1;
  for (int i = 0; i < frame.components && !reader.failed(); ++i) {
    reader.Skip(1);  // Its number.
    const int factors = reader.Fixed<std::uint8_t>();
    reader.Skip(1);  // Its quantisation.
    const int across = std::clamp(factors >> 4, 1, 4);
    const int down = std::clamp(factors & 15, 1, 4);
    sum += across * down;
    most_across = std::max(most_across, across);
    most_down = std::max(most_down, down);
  }
  frame.coefficients = static_cast<double>(sum) / (most_across * most_down);
  return frame;
}

ImageFacts FactsOf(const JpegFrame& frame, bool has_several_scans) {
  constexpr double kCoefficientBytes = 2.0;  // Kept for the whole image between its scans.
  constexpr std::int64_t kRgbBytes = 3;      // Beside the result.
  const std::int64_t pixels = frame.width * frame.height;
  ImageFacts facts{.width = frame.width, .height = frame.height};
  facts.decode_bytes = (kGreyBytes + kRgbBytes) * pixels;
  if (has_several_scans) {
    facts.decode_bytes += static_cast<std::int64_t>(kCoefficientBytes * frame.coefficients *
                                                    static_cast<double>(pixels));
  }
  return facts;
}

// Behind the first two bytes. Segments follow each other: a mark of two bytes, a length of two that
// includes itself. The first scan tells whether there are more.
absl::StatusOr<ImageFacts> JpegFacts(io::ByteReader& reader) {
  constexpr int kFill = 0xff;
  constexpr int kScan = 0xda;
  std::optional<JpegFrame> frame;
  while (!reader.failed()) {
    if (reader.Fixed<std::uint8_t>() != kFill) break;
    int mark = kFill;
    while (mark == kFill && !reader.failed()) mark = reader.Fixed<std::uint8_t>();
    const bool is_frame =
        mark >= 0xc0 && mark <= 0xcf && mark != 0xc4 && mark != 0xc8 && mark != 0xcc;
    if (is_frame && !frame.has_value()) {
      frame = ReadFrame(reader, mark);
      continue;
    }
    const bool is_alone = mark == 0x01 || (mark >= 0xd0 && mark <= 0xd8);
    if (is_alone) continue;
    const std::int64_t length = BigEndian<std::uint16_t>(reader);
    if (length < 2) break;
    if (mark == kScan && frame.has_value()) {
      const int components = reader.Fixed<std::uint8_t>();
      if (reader.failed()) break;
      return FactsOf(*frame, frame->is_progressive || components < frame->components);
    }
    reader.Skip(static_cast<std::uint64_t>(length - 2));
  }
  return Unreadable("the JPEG cannot be read: it does not say its size where it should");
}

constexpr std::string_view kPng("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpeg("\xff\xd8\xff", 3);

// Channels in [0, 1].
float Grey(double red, double green, double blue, double alpha) {
  const double luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  return static_cast<float>(alpha * luma + (1.0 - alpha));
}

absl::Status OutOfMemory() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                   "there is no memory to decode the image");
}

absl::StatusOr<Image> DecodePng(std::span<const char> bytes) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), &spng_ctx_free);
  if (context == nullptr) return OutOfMemory();
  const auto broken = [](int error) {
    return Unreadable(absl::StrCat("the PNG is damaged: ", spng_strerror(error)));
  };
  // Of texts, profiles and the like, which are not looked at.
  constexpr std::size_t kMaxChunk = std::size_t{4} << 20;
  spng_set_chunk_limits(context.get(), kMaxChunk, 2 * kMaxChunk);
  int error = spng_set_png_buffer(context.get(), bytes.data(), bytes.size());
  if (error != SPNG_OK) return broken(error);
  spng_ihdr header = {};
  error = spng_get_ihdr(context.get(), &header);
  if (error != SPNG_OK) return broken(error);

  constexpr std::size_t kChannels = 4;
  constexpr double kOne = 65535.0;
  const std::size_t pixels = std::size_t{header.width} * header.height;
  Image image{.width = static_cast<std::int32_t>(header.width),
              .height = static_cast<std::int32_t>(header.height),
              .values = {}};
  image.values.reserve(pixels);
  const auto take = [&image](const std::vector<std::uint16_t>& values) {
    for (std::size_t i = 0; i < values.size(); i += kChannels) {
      const std::uint16_t* const value = &values[i];
      image.values.push_back(
          Grey(value[0] / kOne, value[1] / kOne, value[2] / kOne, value[3] / kOne));
    }
  };
  // Only an interlaced image has to be there as a whole.
  const bool by_row = header.interlace_method == SPNG_INTERLACE_NONE;
  std::vector<std::uint16_t> values(kChannels * (by_row ? header.width : pixels));
  const std::size_t size = values.size() * sizeof(values[0]);
  if (!by_row) {
    error =
        spng_decode_image(context.get(), values.data(), size, SPNG_FMT_RGBA16, SPNG_DECODE_TRNS);
    if (error != SPNG_OK) return broken(error);
    take(values);
    return image;
  }
  error = spng_decode_image(context.get(), nullptr, 0, SPNG_FMT_RGBA16,
                            SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE);
  for (std::uint32_t row = 0; error == SPNG_OK && row < header.height; ++row) {
    error = spng_decode_row(context.get(), values.data(), size);
    if (error == SPNG_OK || error == SPNG_EOI) take(values);
  }
  // The last row says that it is the last.
  if (error != SPNG_EOI) return broken(error == SPNG_OK ? SPNG_EINTERNAL : error);
  return image;
}

absl::StatusOr<Image> DecodeJpeg(std::span<const char> bytes) {
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

absl::StatusOr<ImageFacts> ReadImageFacts(const ByteSource& source, const ImageLimits& limits) {
  std::string start(static_cast<std::size_t>(std::min<std::int64_t>(source.size, kPng.size())),
                    '\0');
  CCST_RETURN_IF_ERROR(source.read(0, start));
  const bool is_png = start == kPng;
  if (!is_png && !std::string_view(start).starts_with(kJpeg)) {
    return Unreadable("the image is neither a PNG nor a JPEG");
  }
  constexpr std::int64_t kJpegMark = 2;
  io::ByteReader reader(source, is_png ? static_cast<std::int64_t>(kPng.size()) : kJpegMark);
  auto facts = is_png ? PngFacts(reader) : JpegFacts(reader);
  CCST_RETURN_IF_ERROR(reader.status());
  if (!facts.ok()) return facts;
  CCST_RETURN_IF_ERROR(CheckSize(facts->width, facts->height, source.size, limits));
  return facts;
}

absl::StatusOr<Image> DecodeImage(std::span<const char> bytes, const ImageLimits& limits) {
  CCST_RETURN_IF_ERROR(ReadImageFacts(SourceOf(bytes), limits).status());
  const bool is_png = std::string_view(bytes.data(), bytes.size()).starts_with(kPng);
  try {
    return is_png ? DecodePng(bytes) : DecodeJpeg(bytes);
  } catch (const std::bad_alloc&) {
    return OutOfMemory();
  }
}

}  // namespace ccst
