#include "core/io/image_file.h"

#include <array>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <spng.h>
#include <turbojpeg.h>
#include <zlib.h>

#include "core/base/limit_error.h"
#include "tests/core/io/io_test_util.h"

namespace ccst {
namespace {

using ::testing::FloatNear;
using ::testing::Pointwise;

constexpr float kExact = 1e-6f;

struct Png {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint8_t depth = 8;
  spng_color_type type = SPNG_COLOR_TYPE_GRAYSCALE;
  std::vector<unsigned char> rows;  // As the file format packs them; 16 bits in host order.
  std::vector<spng_plte_entry> palette = {};
};

std::string Encode(const Png& png) {
  spng_ctx* const context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_option(context, SPNG_ENCODE_TO_BUFFER, 1);
  spng_ihdr header = {png.width, png.height, png.depth, static_cast<std::uint8_t>(png.type),
                      0,         0,          0};
  spng_set_ihdr(context, &header);
  if (!png.palette.empty()) {
    spng_plte palette = {};
    palette.n_entries = static_cast<std::uint32_t>(png.palette.size());
    std::copy(png.palette.begin(), png.palette.end(), palette.entries);
    spng_set_plte(context, &palette);
  }
  EXPECT_EQ(spng_encode_image(context, png.rows.data(), png.rows.size(), SPNG_FMT_PNG,
                              SPNG_ENCODE_FINALIZE),
            0);
  std::size_t size = 0;
  int error = 0;
  void* const bytes = spng_get_png_buffer(context, &size, &error);
  std::string result(static_cast<const char*>(bytes), size);
  std::free(bytes);
  spng_ctx_free(context);
  return result;
}

// A picture without edges, which JPEG keeps nearly as it is.
std::string SmoothJpeg(int width, int height, int quality, int flags,
                       const std::function<void(double, double, unsigned char*)>& color,
                       int subsampling = TJSAMP_444) {
  std::vector<unsigned char> rgb(static_cast<std::size_t>(3 * width * height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      color(x / (width - 1.0), y / (height - 1.0),
            &rgb[static_cast<std::size_t>(3 * (y * width + x))]);
    }
  }
  const tjhandle encoder = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): the library's type.
  EXPECT_EQ(tjCompress2(encoder, rgb.data(), width, 0, height, TJPF_RGB, &bytes, &size, subsampling,
                        quality, flags),
            0);
  std::string result(reinterpret_cast<const char*>(bytes), size);
  tjFree(bytes);
  tjDestroy(encoder);
  return result;
}

TEST(DecodeImage, GreyPngOfEveryDepth) {
  const auto eight = DecodeImage(Encode({.width = 3, .height = 2, .rows = {0, 51, 255, 1, 2, 3}}));
  ASSERT_TRUE(eight.ok()) << eight.status();
  EXPECT_EQ(eight->width, 3);
  EXPECT_EQ(eight->height, 2);
  EXPECT_THAT(eight->values,
              Pointwise(FloatNear(kExact), {0.0f, 0.2f, 1.0f, 1 / 255.0f, 2 / 255.0f, 3 / 255.0f}));

  const auto one = DecodeImage(Encode({.width = 3, .height = 1, .depth = 1, .rows = {0b10100000}}));
  ASSERT_TRUE(one.ok()) << one.status();
  EXPECT_THAT(one->values, Pointwise(FloatNear(kExact), {1.0f, 0.0f, 1.0f}));

  const std::uint16_t deep[] = {0, 1000, 65535};
  const auto* const bytes = reinterpret_cast<const unsigned char*>(deep);
  const auto sixteen =
      DecodeImage(Encode({.width = 3, .height = 1, .depth = 16, .rows = {bytes, bytes + 6}}));
  ASSERT_TRUE(sixteen.ok()) << sixteen.status();
  EXPECT_THAT(sixteen->values, Pointwise(FloatNear(kExact), {0.0f, 1000 / 65535.0f, 1.0f}));
}

TEST(DecodeImage, ColoursBecomeLumaAndTransparencyIsSeenOnWhite) {
  const auto rgb = DecodeImage(Encode({.width = 4,
                                       .height = 1,
                                       .type = SPNG_COLOR_TYPE_TRUECOLOR,
                                       .rows = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255}}));
  ASSERT_TRUE(rgb.ok()) << rgb.status();
  EXPECT_THAT(rgb->values, Pointwise(FloatNear(kExact), {0.2126f, 0.7152f, 0.0722f, 1.0f}));

  const auto rgba = DecodeImage(Encode({.width = 3,
                                        .height = 1,
                                        .type = SPNG_COLOR_TYPE_TRUECOLOR_ALPHA,
                                        .rows = {0, 0, 0, 0, 0, 0, 0, 51, 255, 0, 0, 255}}));
  ASSERT_TRUE(rgba.ok()) << rgba.status();
  EXPECT_THAT(rgba->values, Pointwise(FloatNear(kExact), {1.0f, 0.8f, 0.2126f}));

  const auto palette = DecodeImage(Encode({.width = 2,
                                           .height = 1,
                                           .type = SPNG_COLOR_TYPE_INDEXED,
                                           .rows = {1, 0},
                                           .palette = {{0, 255, 0, 255}, {0, 0, 255, 255}}}));
  ASSERT_TRUE(palette.ok()) << palette.status();
  EXPECT_THAT(palette->values, Pointwise(FloatNear(kExact), {0.0722f, 0.7152f}));
}

TEST(DecodeImage, JpegBaselineAndProgressive) {
  const auto color = [](double x, double y, unsigned char* rgb) {
    rgb[0] = static_cast<unsigned char>(255 * x);
    rgb[1] = static_cast<unsigned char>(255 * y);
    rgb[2] = static_cast<unsigned char>(255 * (1 - x));
  };
  for (const int flags : {0, TJFLAG_PROGRESSIVE}) {
    const auto image = DecodeImage(SmoothJpeg(40, 25, 100, flags, color));
    ASSERT_TRUE(image.ok()) << image.status();
    ASSERT_EQ(image->width, 40);
    ASSERT_EQ(image->height, 25);
    for (int i = 0; i < 40 * 25; ++i) {
      const double x = (i % 40) / 39.0;
      const double y = (i / 40) / 24.0;
      EXPECT_NEAR(image->values[static_cast<std::size_t>(i)],
                  0.2126 * x + 0.7152 * y + 0.0722 * (1 - x), 0.015);
    }
  }
}

TEST(DecodeImage, PixelLimitComesBeforeTheMemory) {
  std::string bytes = Encode({.width = 40, .height = 25, .rows = std::vector<unsigned char>(1000)});
  EXPECT_TRUE(DecodeImage(bytes, {.max_pixels = 1000}).ok());
  EXPECT_REFUSED(DecodeImage(bytes, {.max_pixels = 999}), ErrorReason::kLimitExceeded,
                 "40 x 25 pixels", "999");
}

TEST(DecodeImage, MoreThanTheBytesCanHoldIsRefusedBeforeTheMemory) {
  // The header of a JPEG: its height and width are behind the marker of the frame.
  std::string jpeg = SmoothJpeg(
      16, 16, 50, 0, [](double, double, unsigned char* rgb) { rgb[0] = rgb[1] = rgb[2] = 9; });
  const std::size_t frame = jpeg.find(std::string("\xff\xc0", 2));
  ASSERT_NE(frame, std::string::npos);
  jpeg.replace(frame + 5, 4, std::string("\x13\x88\x13\x88", 4));
  EXPECT_REFUSED(DecodeImage(jpeg), ErrorReason::kImageUnreadable, "5000 x 5000", "can hold");
  const auto growth = testing::PeakGrowth([&] { (void)DecodeImage(jpeg); });
  EXPECT_GE(growth, 0);
  EXPECT_LT(growth, 8 << 20);
}

// A black PNG of one bit a pixel, as plain zlib makes it; libspng does not write interlaced ones.
std::string BlackPng(std::uint32_t width, std::uint32_t height, bool interlaced) {
  const auto big = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  const auto chunk = [&big](const std::string& name, const std::string& data) {
    const std::string body = name + data;
    const auto sum =
        crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
    return big(static_cast<std::uint32_t>(data.size())) + body +
           big(static_cast<std::uint32_t>(sum));
  };
  // Start and step of the columns and rows of each pass.
  const std::vector<std::array<std::uint32_t, 4>> passes =
      interlaced
          ? std::vector<std::array<std::uint32_t, 4>>{{0, 8, 0, 8}, {4, 8, 0, 8}, {0, 4, 4, 8},
                                                      {2, 4, 0, 4}, {0, 2, 2, 4}, {1, 2, 0, 2},
                                                      {0, 1, 1, 2}}
          : std::vector<std::array<std::uint32_t, 4>>{{0, 1, 0, 1}};
  std::size_t size = 0;
  for (const auto& [x, dx, y, dy] : passes) {
    if (x >= width || y >= height) continue;
    const std::size_t columns = (width - x + dx - 1) / dx;
    const std::size_t rows = (height - y + dy - 1) / dy;
    size += rows * (1 + (columns + 7) / 8);
  }
  const std::string rows(size, '\0');
  uLongf packed_size = compressBound(static_cast<uLong>(size));
  std::string packed(packed_size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &packed_size,
                     reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(size)),
            Z_OK);
  packed.resize(packed_size);
  const std::string header =
      big(width) + big(height) + std::string("\1\0\0\0", 4) + (interlaced ? '\1' : '\0');
  return std::string("\x89PNG\r\n\x1a\n", 8) + chunk("IHDR", header) + chunk("IDAT", packed) +
         chunk("IEND", "");
}

TEST(DecodeImage, InterlacedPngIsTheSamePicture) {
  for (const auto& [width, height] : {std::pair(1U, 1U), std::pair(5U, 3U), std::pair(100U, 37U)}) {
    for (const bool interlaced : {false, true}) {
      const auto image = DecodeImage(BlackPng(width, height, interlaced));
      ASSERT_TRUE(image.ok()) << image.status();
      EXPECT_EQ(image->values, std::vector<float>(std::size_t{width} * height, 0.0F));
    }
  }
}

TEST(ReadImageFacts, SizeStandsInTheHeader) {
  const auto png = ReadImageFacts(SourceOf(BlackPng(300, 200, false)));
  ASSERT_TRUE(png.ok()) << png.status();
  EXPECT_EQ(png->width, 300);
  EXPECT_EQ(png->height, 200);
  const std::string jpeg = SmoothJpeg(
      40, 25, 90, 0, [](double, double, unsigned char* rgb) { rgb[0] = rgb[1] = rgb[2] = 9; });
  const auto baseline = ReadImageFacts(SourceOf(jpeg));
  ASSERT_TRUE(baseline.ok()) << baseline.status();
  EXPECT_EQ(baseline->width, 40);
  EXPECT_EQ(baseline->height, 25);
  // Texts and profiles may stand before it.
  std::string with_texts = jpeg.substr(0, 2);
  for (int i = 0; i < 3; ++i) with_texts += "\xff\xfe\xff\xfe" + std::string(0xfffc, 'x');
  with_texts += jpeg.substr(2);
  const auto behind = ReadImageFacts(SourceOf(with_texts));
  ASSERT_TRUE(behind.ok()) << behind.status();
  EXPECT_EQ(behind->width, 40);
}

TEST(ReadImageFacts, TooManyPixelsAreRefusedWithTheLimit) {
  const absl::Status status =
      ReadImageFacts(SourceOf(BlackPng(40, 25, false)), {.max_pixels = 999}).status();
  EXPECT_EQ(GetErrorReason(status), ErrorReason::kLimitExceeded);
  ASSERT_TRUE(GetPassedLimit(status).has_value());
  EXPECT_EQ(GetPassedLimit(status)->name, "max_texture_pixels");
  EXPECT_EQ(GetPassedLimit(status)->value, 999);
  EXPECT_EQ(GetPassedLimit(status)->requested, 1000);
}

TEST(DecodeImage, TakesTheMemoryThatItsHeaderAnnounces) {
  const auto grey = [](double x, double, unsigned char* rgb) {
    rgb[0] = rgb[1] = rgb[2] = static_cast<unsigned char>(255 * x);
  };
  const std::string files[] = {BlackPng(2000, 1500, false),
                               BlackPng(2000, 1500, true),
                               SmoothJpeg(2000, 1500, 80, 0, grey),
                               SmoothJpeg(2000, 1500, 80, TJFLAG_PROGRESSIVE, grey),
                               SmoothJpeg(2000, 1500, 80, TJFLAG_PROGRESSIVE, grey, TJSAMP_420),
                               SmoothJpeg(2000, 1500, 80, TJFLAG_PROGRESSIVE, grey, TJSAMP_422),
                               SmoothJpeg(2000, 1500, 80, TJFLAG_PROGRESSIVE, grey, TJSAMP_GRAY)};
  for (std::size_t i = 0; i < std::size(files); ++i) {
    const std::int64_t announced = ReadImageFacts(SourceOf(files[i]))->decode_bytes;
    // What the heap kept of freed memory would be used first and not be seen.
    malloc_trim(0);
    const std::int64_t growth = testing::PeakGrowth([&] { (void)DecodeImage(files[i]); });
    ASSERT_GE(growth, 0);
    EXPECT_LT(static_cast<double>(growth), 1.5 * static_cast<double>(announced)) << i;
    if (growth > 0) {
      EXPECT_LT(static_cast<double>(announced), 1.5 * static_cast<double>(growth)) << i;
    }
  }
}

TEST(DecodeImage, OtherFilesAndTruncationsAreRefused) {
  EXPECT_REFUSED(DecodeImage({}), ErrorReason::kImageUnreadable, "neither");
  EXPECT_REFUSED(DecodeImage(std::string("GIF89a")), ErrorReason::kImageUnreadable, "neither");
  std::mt19937 random(1);
  std::vector<unsigned char> noise(30 * 20);
  for (unsigned char& value : noise) value = static_cast<unsigned char>(random());
  const std::string png = Encode({.width = 30, .height = 20, .rows = noise});
  const std::string jpeg = SmoothJpeg(30, 20, 90, 0, [](double x, double y, unsigned char* rgb) {
    rgb[0] = rgb[1] = rgb[2] = static_cast<unsigned char>(255 * x * y);
  });
  // All but what comes behind the last pixel.
  for (std::size_t size = 0; size + 20 < png.size(); size += 7) {
    EXPECT_REFUSED(DecodeImage(std::span(png).first(size)), ErrorReason::kImageUnreadable);
  }
  for (std::size_t size = 0; size + 3 < jpeg.size(); size += 3) {
    EXPECT_REFUSED(DecodeImage(std::span(jpeg).first(size)), ErrorReason::kImageUnreadable);
  }
}

TEST(DecodeImage, ChangedBytesGiveAnImageOrARefusal) {
  std::mt19937 random(2);
  const std::string files[] = {
      Encode({.width = 9, .height = 7, .rows = std::vector<unsigned char>(63, 77)}),
      SmoothJpeg(20, 20, 80, TJFLAG_PROGRESSIVE, [](double x, double, unsigned char* rgb) {
        rgb[0] = rgb[1] = rgb[2] = static_cast<unsigned char>(255 * x);
      })};
  for (const std::string& file : files) {
    for (int round = 0; round < 2000; ++round) {
      std::string bytes = file;
      for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      const auto image = DecodeImage(bytes, {.max_pixels = 1 << 20});
      if (image.ok()) {
        EXPECT_EQ(image->values.size(),
                  static_cast<std::size_t>(image->width) * static_cast<std::size_t>(image->height));
      } else {
        EXPECT_TRUE(GetErrorReason(image.status()).has_value()) << image.status();
      }
    }
  }
}

}  // namespace
}  // namespace ccst
