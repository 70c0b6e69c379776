#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

using ::testing::ElementsAre;

std::string Binary(const std::string& header, std::initializer_list<std::array<float, 9>> facets) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  AppendLittleEndian(bytes, static_cast<std::uint32_t>(facets.size()));
  for (const auto& facet : facets) {
    bytes.append(12, '\0');
    for (const float value : facet) AppendLittleEndian(bytes, value);
    bytes.append(2, '\0');
  }
  return bytes;
}

constexpr std::array<float, 9> kFirst = {0, 0, 0, 1, 0, 0, 0, 1, 0};
constexpr std::array<float, 9> kSecond = {1, 0, 0, 1, 1, 0, 0, 1, 0};

constexpr char kText[] =
    "solid two words\n"
    " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
    "  endloop\n endfacet\n"
    " FACET NORMAL nan nan nan\n  Outer Loop\n   vertex 1 0 0\n   vertex 1.0 1e0 0\n"
    "   vertex 0 1 0\n  endloop\n endfacet\n"
    "endsolid two words\n";

void ExpectTwoTriangles(const absl::StatusOr<MeshFile>& file) {
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.positions,
              ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                          Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 1, 0)));
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(1, 3, 2)));
  EXPECT_TRUE(file->face_source.empty());
}

TEST(StlReader, TextSharesEqualVertices) { ExpectTwoTriangles(ReadStl(kText, {})); }

TEST(StlReader, BinarySharesEqualVertices) {
  ExpectTwoTriangles(ReadStl(Binary("made here", {kFirst, kSecond}), {}));
}

TEST(StlReader, BinaryThatBeginsWithSolid) {
  ExpectTwoTriangles(ReadStl(Binary("solid thing", {kFirst, kSecond}), {}));
}

TEST(StlReader, BytesBehindTheFacetsAreIgnored) {
  ExpectTwoTriangles(ReadStl(Binary("x", {kFirst, kSecond}) + "tail", {}));
  ExpectTwoTriangles(ReadStl(Binary("solid", {kFirst, kSecond}) + "tail", {}));
}

TEST(StlReader, NegativeZeroIsZero) {
  const auto file = ReadStl(Binary("x", {kFirst, {1, -0.0f, 0, 1, 1, 0, -0.0f, 1, -0.0f}}), {});
  ExpectTwoTriangles(file);
}

TEST(StlReader, NearlyEqualVerticesStayApart) {
  const auto file = ReadStl(Binary("x", {kFirst, {1, 1e-30f, 0, 1, 1, 0, 0, 1, 0}}), {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.positions.size(), 5u);
}

TEST(StlReader, SeveralSolids) {
  const auto file = ReadStl(std::string(kText) + kText, {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 4u);
  EXPECT_EQ(file->mesh.positions.size(), 4u);
}

TEST(StlReader, SyntaxErrorsNameLineOrByte) {
  EXPECT_REFUSED(ReadStl("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", {}),
                 ErrorReason::kMeshUnreadable, "line 4", "'x'");
  EXPECT_REFUSED(ReadStl("solid\nfacet normal 0 0 1\nouter ring\n", {}),
                 ErrorReason::kMeshUnreadable, "line 3", "'loop'", "'ring'");
  EXPECT_REFUSED(ReadStl("solid\nface\n", {}), ErrorReason::kMeshUnreadable, "line 2", "'face'");
  EXPECT_REFUSED(ReadStl(std::string_view(kText).substr(0, 200), {}), ErrorReason::kMeshUnreadable,
                 "line");
  std::string no_end = kText;
  no_end.resize(no_end.find("endsolid"));
  EXPECT_TRUE(ReadStl(no_end, {}).ok());
  EXPECT_REFUSED(ReadStl("short", {}), ErrorReason::kMeshUnreadable, "5 bytes");
}

TEST(StlReader, AnnouncedFacetsMustBeThere) {
  std::string bytes = Binary("x", {kFirst, kSecond});
  bytes.resize(bytes.size() - 1);
  EXPECT_REFUSED(ReadStl(bytes, {}), ErrorReason::kMeshUnreadable, "byte 80", "2 facets",
                 "after 1");
  const std::uint32_t huge = 0xffffffffu;
  std::memcpy(bytes.data() + 80, &huge, 4);
  EXPECT_REFUSED(ReadStl(bytes, {}), ErrorReason::kMeshUnreadable, "4294967295 facets");
}

TEST(StlReader, CountOfZeroMeansAllFacets) {
  std::string bytes = Binary("x", {kFirst, kSecond});
  std::memset(bytes.data() + 80, 0, 4);
  const auto file = ReadStl(bytes, {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 2u);
}

TEST(StlReader, BadContentNamesTheCulprit) {
  EXPECT_REFUSED(ReadStl(Binary("x", {kFirst, {0, 0, 0, 1, 0, 0, 0, 1, NAN}}), {}),
                 ErrorReason::kMeshDegenerate, "byte 170", "z = nan");
  EXPECT_REFUSED(ReadStl("solid\nendsolid\n", {}), ErrorReason::kMeshEmpty);
  EXPECT_REFUSED(ReadStl(Binary("x", {}), {}), ErrorReason::kMeshEmpty);
  EXPECT_REFUSED(ReadStl(Binary("x", {kFirst, kSecond}), {.max_faces = 1}),
                 ErrorReason::kLimitExceeded, "2 faces");
}

}  // namespace
}  // namespace ccst::io
