#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

using ::testing::ElementsAre;

// Appends in the byte order asked for.
class Bytes {
 public:
  explicit Bytes(std::endian order) : order_(order) {}
  template <typename T>
  Bytes& Add(T value) {
    std::string piece;
    AppendLittleEndian(piece, value);
    if (order_ == std::endian::big) piece.assign(piece.rbegin(), piece.rend());
    bytes_ += piece;
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  std::endian order_;
  std::string bytes_;
};

std::string Header(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\ncomment made here\nobj_info x\n" + rest + "end_header\n";
}

constexpr char kPlain[] =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\n";

constexpr char kBusy[] =
    "element camera 2\nproperty list uchar short tags\nproperty double zoom\n"
    "element vertex 3\nproperty uchar red\nproperty double z\nproperty list int float weights\n"
    "property short y\nproperty float x\n"
    "element face 2\nproperty uchar flags\nproperty list ushort uint vertex_index\n"
    "property list uchar float texcoord\nproperty int number\n"
    "element edge 1\nproperty int a\n";

TEST(PlyReader, AsciiWithEverythingElsePassedOver) {
  const auto file = ReadPly(Header("ascii", kBusy) +
                                "2 5 6 1.5\n0 2.5\n"
                                "255 0.125 0 2 1.5\n7 0.25 2 0.5 0.5 -3 2.5\n7 0.5 0 4 3.5\n"
                                "1 3 0 1 2 0 9\n0 4 0 1 2 0 2 0.5 0.5 8\n"
                                "5\n",
                            {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.positions,
              ElementsAre(Eigen::Vector3d(1.5, 2, 0.125), Eigen::Vector3d(2.5, -3, 0.25),
                          Eigen::Vector3d(3.5, 4, 0.5)));
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 1, 2),
                                            Eigen::Vector3i(0, 2, 0)));
  EXPECT_THAT(file->face_source, ElementsAre(0, 1, 1));
}

TEST(PlyReader, BinaryInBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    Bytes data(order);
    data.Add(std::uint8_t{1}).Add(std::int16_t{5}).Add(1.5);
    data.Add(std::uint8_t{0}).Add(2.5);
    for (int i = 0; i < 3; ++i) {
      data.Add(std::uint8_t{255}).Add(0.5 * i).Add(std::int32_t{i});
      for (int k = 0; k < i; ++k) data.Add(0.25f);
      data.Add(static_cast<std::int16_t>(-i)).Add(1.5f + static_cast<float>(i));
    }
    for (int i = 0; i < 2; ++i) {
      data.Add(std::uint8_t{1}).Add(std::uint16_t{3});
      for (std::uint32_t k = 0; k < 3; ++k) data.Add(k);
      data.Add(std::uint8_t{0}).Add(std::int32_t{9});
    }
    data.Add(std::int32_t{1});
    const auto file = ReadPly(
        Header(order == std::endian::big ? "binary_big_endian" : "binary_little_endian", kBusy) +
            data.str(),
        {});
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_THAT(file->mesh.positions,
                ElementsAre(Eigen::Vector3d(1.5, 0, 0), Eigen::Vector3d(2.5, -1, 0.5),
                            Eigen::Vector3d(3.5, -2, 1)));
    EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 1, 2)));
    EXPECT_TRUE(file->face_source.empty());
  }
}

TEST(PlyReader, FacesMayPrecedeVertices) {
  const std::string header = Header("ascii",
                                    "element face 1\nproperty list uchar int vertex_indices\n"
                                    "element vertex 3\nproperty float x\nproperty float y\n"
                                    "property float z\n");
  EXPECT_TRUE(ReadPly(header + "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n", {}).ok());
  EXPECT_REFUSED(ReadPly(header + "3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n", {}),
                 ErrorReason::kMeshDegenerate, "face 0", "vertex 3");
}

TEST(PlyReader, BadHeadersNameTheLine) {
  EXPECT_REFUSED(ReadPly("plx\n", {}), ErrorReason::kMeshUnreadable, "line 1");
  EXPECT_REFUSED(ReadPly("ply\nformat ascii 2.0\nend_header\n", {}), ErrorReason::kMeshUnreadable,
                 "line 2", "'2.0'");
  EXPECT_REFUSED(ReadPly("ply\nformat text 1.0\nend_header\n", {}), ErrorReason::kMeshUnreadable,
                 "line 2", "'text'");
  EXPECT_REFUSED(ReadPly("ply\nend_header\n", {}), ErrorReason::kMeshUnreadable, "format");
  EXPECT_REFUSED(ReadPly("ply\nformat ascii 1.0\n", {}), ErrorReason::kMeshUnreadable,
                 "end_header");
  EXPECT_REFUSED(ReadPly(Header("ascii", "property float x\n"), {}), ErrorReason::kMeshUnreadable,
                 "line 5", "before any");
  EXPECT_REFUSED(ReadPly(Header("ascii", "element vertex -3\n"), {}), ErrorReason::kMeshUnreadable,
                 "line 5", "'-3'");
  EXPECT_REFUSED(ReadPly(Header("ascii", "element v 1\nproperty quad x\n"), {}),
                 ErrorReason::kMeshUnreadable, "line 6", "'quad'");
  EXPECT_REFUSED(ReadPly(Header("ascii", "element v 1\nproperty list float int x\n"), {}),
                 ErrorReason::kMeshUnreadable, "line 6", "integer");
  EXPECT_REFUSED(ReadPly(Header("ascii", "nonsense\n"), {}), ErrorReason::kMeshUnreadable, "line 5",
                 "'nonsense'");
}

TEST(PlyReader, NeedsPositionsAndCorners) {
  EXPECT_REFUSED(ReadPly(Header("ascii", "element vertex 1\nproperty float x\n") + "1\n", {}),
                 ErrorReason::kMeshUnreadable, "x, y and z");
  EXPECT_REFUSED(
      ReadPly(Header("ascii", "element face 1\nproperty list uchar float vertex_indices\n") + "0\n",
              {}),
      ErrorReason::kMeshUnreadable, "vertex_indices");
}

TEST(PlyReader, StripsAlternateAndStartAnewAfterMinusOne) {
  const auto file =
      ReadPly(Header("ascii",
                     "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
                     "element tristrips 1\nproperty list int int vertex_indices\n") +
                  "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n8 0 1 2 3 -1 2 3 4\n",
              {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(2, 1, 3),
                                            Eigen::Vector3i(2, 3, 4)));
}

TEST(PlyReader, BadDataNamesLineOrByte) {
  const std::string ascii = Header("ascii", kPlain);
  EXPECT_REFUSED(ReadPly(ascii + "0 0 0\n1 0 0\n0 one 0\n3 0 1 2\n", {}),
                 ErrorReason::kMeshUnreadable, "line 14", "vertex 2 of 3", "'y'");
  EXPECT_REFUSED(ReadPly(ascii + "0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", {}),
                 ErrorReason::kMeshDegenerate, "line 14", "vertex 2", "y = nan");
  EXPECT_REFUSED(ReadPly(ascii + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {}),
                 ErrorReason::kMeshDegenerate, "line 15", "face 0", "vertex 3");
  EXPECT_REFUSED(ReadPly(ascii + "0 0 0\n1 0 0\n0 1 0\n200 0 1 3\n", {}),
                 ErrorReason::kMeshUnreadable, "line 15", "announces 200 items");
  const std::string binary = Header("binary_little_endian", kPlain);
  EXPECT_REFUSED(ReadPly(binary + std::string(30, '\0'), {}), ErrorReason::kMeshUnreadable,
                 "byte " + std::to_string(binary.size()), "3 records of 'vertex'");
  EXPECT_REFUSED(ReadPly(binary + std::string(36, '\0') + "\x03", {}), ErrorReason::kMeshUnreadable,
                 "announces 3 items");
}

TEST(PlyReader, AnnouncedCountsAreHeldAgainstLimitsAndBytes) {
  const std::string huge =
      "element vertex 2000000000\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_REFUSED(ReadPly(Header("ascii", huge), {}), ErrorReason::kLimitExceeded,
                 "2000000000 vertices");
  const MeshLimits generous = {.max_vertices = std::int64_t{1} << 62};
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string bytes = Header(format, huge) + "0 0 0\n";
    EXPECT_REFUSED(ReadPly(bytes, generous), ErrorReason::kMeshUnreadable, "bytes are left");
    const auto growth = testing::PeakGrowth([&] { (void)ReadPly(bytes, generous); });
    EXPECT_GE(growth, 0);
    EXPECT_LT(growth, 8 << 20) << format;
  }
  // Records of no bytes do not take time either.
  EXPECT_REFUSED(ReadPly(Header("ascii", "element nothing 9000000000000000000\n"), {}),
                 ErrorReason::kMeshEmpty);
  EXPECT_REFUSED(ReadPly(Header("ascii", "element list 9000000000000000000\nproperty int a\n"), {}),
                 ErrorReason::kMeshUnreadable, "bytes are left");
}

}  // namespace
}  // namespace ccst::io
