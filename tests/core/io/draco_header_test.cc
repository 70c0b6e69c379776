#include "core/io/draco_header.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

std::string Stream(int major, int minor, int type, int method, int flags, const std::string& rest) {
  std::string bytes = "DRACO";
  for (const int value : {major, minor, type, method, flags & 255, flags >> 8}) {
    bytes += static_cast<char>(value);
  }
  return bytes + rest;
}

std::string Bytes(std::initializer_list<int> values) {
  std::string bytes;
  for (const int value : values) bytes += static_cast<char>(value);
  return bytes;
}

TEST(DracoHeader, SequentialCountsInBothForms) {
  const auto fixed = ReadDracoHeader(Stream(1, 1, 1, 0, 0, Bytes({170, 0, 0, 0, 97, 0, 0, 0, 1})));
  ASSERT_TRUE(fixed.ok()) << fixed.status();
  EXPECT_EQ(fixed->faces, 170);
  EXPECT_EQ(fixed->points, 97);
  EXPECT_FALSE(fixed->compressed_indices);
  EXPECT_EQ(fixed->counts_offset, 11u);
  EXPECT_EQ(fixed->data_offset, 20u);
  const auto varint = ReadDracoHeader(Stream(2, 2, 1, 0, 0, Bytes({0xaa, 1, 97, 0})));
  ASSERT_TRUE(varint.ok()) << varint.status();
  EXPECT_EQ(varint->faces, 170);
  EXPECT_EQ(varint->points, 97);
  EXPECT_TRUE(varint->compressed_indices);
}

TEST(DracoHeader, EdgebreakerCountsInAllThreeForms) {
  const auto expect = [](const absl::StatusOr<DracoHeader>& header) {
    ASSERT_TRUE(header.ok()) << header.status();
    EXPECT_EQ(header->method, DracoMethod::kEdgebreaker);
    EXPECT_EQ(header->points, 99);
    EXPECT_EQ(header->faces, 170);
    EXPECT_EQ(header->attribute_connectivities, 1);
    EXPECT_EQ(header->symbols, 170);
    EXPECT_EQ(header->split_symbols, 17);
  };
  expect(ReadDracoHeader(Stream(1, 2, 1, 1, 0, Bytes({0, 2, 0, 0,   0, 99, 0, 0,  0, 170, 0,
                                                      0, 0, 1, 170, 0, 0,  0, 17, 0, 0,   0}))));
  expect(ReadDracoHeader(Stream(2, 0, 1, 1, 0, Bytes({0, 2, 99, 0xaa, 1, 1, 0xaa, 1, 17}))));
  expect(ReadDracoHeader(Stream(2, 2, 1, 1, 0, Bytes({0, 99, 0xaa, 1, 1, 0xaa, 1, 17}))));
}

TEST(DracoHeader, MetadataIsPassedOver) {
  const std::string counts = Bytes({0xaa, 1, 97, 1});
  // One attribute's metadata, then the geometry's: entries and a nested one each.
  const std::string metadata = Bytes({1, 42}) + Bytes({1, 4}) + "name" + Bytes({2}) + "ab" +
                               Bytes({1, 1}) + "n" + Bytes({0, 0}) + Bytes({0, 0});
  const auto header = ReadDracoHeader(Stream(2, 2, 1, 0, 0x8000, metadata + counts));
  ASSERT_TRUE(header.ok()) << header.status();
  EXPECT_TRUE(header->has_metadata);
  EXPECT_EQ(header->faces, 170);
  EXPECT_EQ(header->counts_offset, 11 + metadata.size());
  for (std::size_t size = 0; size < metadata.size(); ++size) {
    EXPECT_REFUSED(ReadDracoHeader(Stream(2, 2, 1, 0, 0x8000, metadata.substr(0, size))),
                   ErrorReason::kDracoDecodeFailed, "metadata");
  }
  EXPECT_REFUSED(ReadDracoHeader(Stream(2, 2, 1, 0, 0x8000, Bytes({0, 1, 1, 'n', 0xff, 0x7f, 0}))),
                 ErrorReason::kDracoDecodeFailed, "metadata");
}

TEST(DracoHeader, DeeplyNestedMetadataIsRefused) {
  std::string nested = Bytes({0});
  for (int i = 0; i < 100000; ++i) nested += Bytes({0, 1, 0});
  EXPECT_REFUSED(ReadDracoHeader(Stream(2, 2, 1, 0, 0x8000, nested)),
                 ErrorReason::kDracoDecodeFailed, "metadata");
}

TEST(DracoHeader, OtherStreamsAreNamed) {
  EXPECT_REFUSED(ReadDracoHeader(Bytes({})), ErrorReason::kDracoDecodeFailed, "byte 0", "DRACO");
  EXPECT_REFUSED(ReadDracoHeader(std::string("DRACK0000000")), ErrorReason::kDracoDecodeFailed,
                 "byte 0");
  EXPECT_REFUSED(ReadDracoHeader(Stream(2, 3, 0, 1, 0, "")), ErrorReason::kDracoDecodeFailed,
                 "point cloud");
  EXPECT_REFUSED(ReadDracoHeader(Stream(2, 2, 2, 1, 0, "")), ErrorReason::kDracoDecodeFailed,
                 "byte 7", "type 2");
  EXPECT_REFUSED(ReadDracoHeader(Stream(2, 3, 1, 1, 0, "")), ErrorReason::kDracoDecodeFailed,
                 "version 2.3");
  EXPECT_REFUSED(ReadDracoHeader(Stream(2, 2, 1, 2, 0, "")), ErrorReason::kDracoDecodeFailed,
                 "method 2");
}

TEST(DracoHeader, EveryTruncationIsRefused) {
  const std::string whole = Stream(2, 2, 1, 1, 0, Bytes({0, 99, 0xaa, 1, 1, 0xaa, 1, 17}));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_REFUSED(ReadDracoHeader(std::span(whole).first(size)), ErrorReason::kDracoDecodeFailed);
  }
}

TEST(DracoHeader, CountsOfMoreThan32BitsAreRefused) {
  EXPECT_REFUSED(
      ReadDracoHeader(Stream(2, 2, 1, 0, 0, Bytes({0xff, 0xff, 0xff, 0xff, 0x1f, 3, 1}))),
      ErrorReason::kDracoDecodeFailed);
  EXPECT_REFUSED(
      ReadDracoHeader(Stream(2, 2, 1, 0, 0, Bytes({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1}))),
      ErrorReason::kDracoDecodeFailed);
}

DracoHeader Sequential(std::int64_t faces, std::int64_t points, bool compressed) {
  return {.version_major = 2,
          .version_minor = 2,
          .method = DracoMethod::kSequential,
          .faces = faces,
          .points = points,
          .compressed_indices = compressed};
}

DracoHeader Edgebreaker(std::int64_t faces, std::int64_t vertices, std::int64_t symbols,
                        int traversal) {
  return {.method = DracoMethod::kEdgebreaker,
          .faces = faces,
          .points = vertices,
          .traversal = traversal,
          .symbols = symbols};
}

TEST(DracoCounts, LimitsComeFirst) {
  EXPECT_REFUSED(CheckDracoCounts(Sequential(101, 3, false), 10, {.max_faces = 100}),
                 ErrorReason::kLimitExceeded, "101 faces");
  EXPECT_REFUSED(CheckDracoCounts(Sequential(1, 101, false), 10, {.max_vertices = 100}),
                 ErrorReason::kLimitExceeded, "101 vertices");
  EXPECT_REFUSED(CheckDracoCounts(Sequential(0, 5, false), 10, {}), ErrorReason::kMeshEmpty,
                 "5 vertices");
}

TEST(DracoCounts, RawIndicesTakeTheirBytes) {
  // Three indices of one, two, one (variable length) and four bytes.
  const std::pair<std::int64_t, std::size_t> cases[] = {
      {255, 3}, {256, 6}, {65535, 6}, {65536, 3}, {(1 << 21) - 1, 3}, {1 << 21, 12}};
  for (const auto& [points, bytes] : cases) {
    const MeshLimits limits = {.max_decoded_bytes = std::int64_t{1} << 40};
    // Large enough for the memory budget to be out of the way.
    const std::int64_t faces = 1'000'000;
    const auto header = Sequential(faces, points, false);
    EXPECT_TRUE(CheckDracoCounts(header, static_cast<std::size_t>(faces) * bytes, limits).ok());
    EXPECT_REFUSED(CheckDracoCounts(header, static_cast<std::size_t>(faces) * bytes - 1, limits),
                   ErrorReason::kDracoDecodeFailed, std::to_string(bytes) + " bytes a face");
  }
}

TEST(DracoCounts, StandardTraversalTakesABitASymbol) {
  EXPECT_TRUE(CheckDracoCounts(Edgebreaker(8000, 4000, 8000, 0), 1000, {}).ok());
  EXPECT_REFUSED(CheckDracoCounts(Edgebreaker(8001, 4000, 8001, 0), 1000, {}),
                 ErrorReason::kDracoDecodeFailed, "a bit a symbol");
  EXPECT_TRUE(CheckDracoCounts(Edgebreaker(8001, 4000, 8001, 2), 1000, {}).ok());
}

TEST(DracoCounts, ContradictionsAreRefused) {
  EXPECT_TRUE(CheckDracoCounts(Edgebreaker(12, 8, 9, 0), 100, {}).ok());
  EXPECT_REFUSED(CheckDracoCounts(Edgebreaker(13, 8, 9, 0), 100, {}),
                 ErrorReason::kDracoDecodeFailed, "contradicts");
  EXPECT_REFUSED(CheckDracoCounts(Edgebreaker(9, 8, 10, 0), 100, {}),
                 ErrorReason::kDracoDecodeFailed, "contradicts");
  EXPECT_REFUSED(CheckDracoCounts(Edgebreaker(12, 37, 12, 0), 100, {}),
                 ErrorReason::kDracoDecodeFailed, "corners");
}

TEST(DracoCounts, EntropyCodedStreamsAreHeldToAMemoryBudget) {
  EXPECT_TRUE(CheckDracoCounts(Edgebreaker(200000, 100000, 200000, 2), 90, {}).ok());
  EXPECT_REFUSED(CheckDracoCounts(Edgebreaker(2000000, 1000000, 2000000, 2), 90, {}),
                 ErrorReason::kDracoDecodeFailed, "2000000 faces", "90 bytes");
  DracoHeader seams = Edgebreaker(200000, 100000, 200000, 2);
  seams.attribute_connectivities = 255;
  EXPECT_REFUSED(CheckDracoCounts(seams, 1000, {}), ErrorReason::kDracoDecodeFailed);
  EXPECT_REFUSED(CheckDracoCounts(Edgebreaker(200000, 100000, 200000, 2), 1 << 20,
                                  {.max_decoded_bytes = 1 << 20}),
                 ErrorReason::kLimitExceeded, "MiB");
}

}  // namespace
}  // namespace ccst::io
