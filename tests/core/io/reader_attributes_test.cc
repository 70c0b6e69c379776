#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"
#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

using ::testing::ElementsAre;

std::string PlyHeaderText(const std::string& format, int vertices, const std::string& properties,
                          int faces, const std::string& face_properties = "") {
  std::string header = "ply\nformat " + format + " 1.0\nelement vertex " +
                       std::to_string(vertices) + "\n" + properties + "element face " +
                       std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  return header + face_properties + "end_header\n";
}

constexpr char kXyz[] = "property float x\nproperty float y\nproperty float z\n";

void ExpectAttribute(const TriangleMesh& mesh, const std::string& name, AttributeKind kind,
                     int components, bool per_corner, const std::vector<float>& values) {
  const Attribute* const attribute = FindAttribute(mesh.attributes, name);
  ASSERT_NE(attribute, nullptr) << name;
  EXPECT_EQ(attribute->kind, kind) << name;
  EXPECT_EQ(attribute->components, components) << name;
  EXPECT_EQ(attribute->per_corner, per_corner) << name;
  EXPECT_EQ(attribute->values, values) << name;
}

TEST(PlyAttributes, ColoursTextureCoordinatesAndScalarsOfVertices) {
  const std::string properties =
      "property uchar green\nproperty float x\nproperty float nx\nproperty float y\n"
      "property uchar red\nproperty float z\nproperty uchar blue\nproperty uchar alpha\n"
      "property float t\nproperty double s\nproperty float quality\nproperty int label\n"
      "property float ny\nproperty float nz\nproperty list uchar int tags\n";
  const auto file = ReadPly(PlyHeaderText("ascii", 3, properties, 1) +
                                "51 0 9 0 255 0 0 255 0.5 0.25 1.5 -3 9 9 0\n"
                                "0 1 9 0 102 0 204 51 0.75 1 2.5 70000 9 9 2 5 6\n"
                                "0 0 9 1 0 0 0 0 0 0 nan 0 9 9 0\n3 0 1 2\n",
                            {});
  ASSERT_TRUE(file.ok()) << file.status();
  const TriangleMesh& mesh = file->mesh;
  ASSERT_EQ(mesh.attributes.size(), 4u);
  ExpectAttribute(mesh, "color", AttributeKind::kColor, 4, false,
                  {1, 0.2f, 0, 1, 0.4f, 0, 0.8f, 0.2f, 0, 0, 0, 0});
  ExpectAttribute(mesh, "uv", AttributeKind::kTextureCoordinates, 2, false,
                  {0.25f, 0.5f, 1, 0.75f, 0, 0});
  ExpectAttribute(mesh, "label", AttributeKind::kLabel, 1, false, {-3, 70000, 0});
  const Attribute* const quality = FindAttribute(mesh.attributes, "quality");
  ASSERT_NE(quality, nullptr);
  EXPECT_EQ(quality->values[1], 2.5f);
  EXPECT_TRUE(std::isnan(quality->values[2]));
  EXPECT_TRUE(CheckAttributes(mesh).ok());
}

TEST(PlyAttributes, ColoursOfEveryTypeAreFractions) {
  for (const auto& [type, one] :
       {std::pair("uchar", "255"), {"ushort", "65535"}, {"float", "1.0"}, {"double", "1"}}) {
    std::string properties = kXyz;
    for (const char* name : {"red", "green", "blue"}) {
      properties += std::string("property ") + type + " " + name + "\n";
    }
    const auto file = ReadPly(PlyHeaderText("ascii", 3, properties, 1) + "0 0 0 " + one +
                                  " 0 0\n1 0 0 0 " + one + " 0\n0 1 0 0 0 " + one + "\n3 0 1 2\n",
                              {});
    ASSERT_TRUE(file.ok()) << file.status();
    ExpectAttribute(file->mesh, "color", AttributeKind::kColor, 3, false,
                    {1, 0, 0, 0, 1, 0, 0, 0, 1});
  }
}

TEST(PlyAttributes, WhatIsNoWholeColourOrPairIsAScalar) {
  const std::string properties =
      std::string(kXyz) + "property uchar red\nproperty uchar green\nproperty float u\n";
  const auto file = ReadPly(PlyHeaderText("ascii", 3, properties, 1) +
                                "0 0 0 1 2 0.5\n1 0 0 3 4 0.5\n0 1 0 5 6 0.5\n3 0 1 2\n",
                            {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 3u);
  ExpectAttribute(file->mesh, "red", AttributeKind::kLabel, 1, false, {1, 3, 5});
  ExpectAttribute(file->mesh, "u", AttributeKind::kScalar, 1, false, {0.5f, 0.5f, 0.5f});
}

TEST(PlyAttributes, BinaryValues) {
  std::string data;
  for (int i = 0; i < 3; ++i) {
    for (const float value : {i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f, 0.0f}) {
      AppendLittleEndian(data, value);
    }
    data += static_cast<char>(51 * i);
    data += std::string(2, '\xff');
    AppendLittleEndian(data, 0.5 + i);
  }
  data += '\x03';
  for (const std::int32_t corner : {0, 1, 2}) AppendLittleEndian(data, corner);
  const auto file =
      ReadPly(PlyHeaderText("binary_little_endian", 3,
                            std::string(kXyz) +
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "property double heat\n",
                            1) +
                  data,
              {});
  ASSERT_TRUE(file.ok()) << file.status();
  ExpectAttribute(file->mesh, "color", AttributeKind::kColor, 3, false,
                  {0, 1, 1, 0.2f, 1, 1, 0.4f, 1, 1});
  ExpectAttribute(file->mesh, "heat", AttributeKind::kScalar, 1, false, {0.5f, 1.5f, 2.5f});
}

TEST(PlyAttributes, TextureListsOfFacesFollowTheFans) {
  const std::string header =
      PlyHeaderText("ascii", 4, kXyz, 3, "property list uchar float texcoord\n") +
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  // A face without coordinates, a quad with, a triangle with.
  const auto file = ReadPly(
      header + "3 0 1 2 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 2 1 0 6 0.5 0.5 0.25 0 0 0.75\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  ExpectAttribute(file->mesh, "uv", AttributeKind::kTextureCoordinates, 2, true,
                  {0,    0,    0,     0, 0, 0,  //
                   0,    0,    1,     0, 1, 1,  //
                   0,    0,    1,     1, 0, 1,  //
                   0.5f, 0.5f, 0.25f, 0, 0, 0.75f});
  EXPECT_TRUE(CheckAttributes(file->mesh).ok());
  const auto without = ReadPly(header + "3 0 1 2 0\n3 0 1 2 0\n3 0 1 2 2 1 1\n", {});
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_TRUE(without->mesh.attributes.empty());
}

TEST(PlyAttributes, NamesAreMadeFitAndUnique) {
  const std::string properties =
      std::string(kXyz) + "property float heat\nproperty float heat\nproperty float a,b\xc3\xa9\n";
  const auto file = ReadPly(
      PlyHeaderText("ascii", 3, properties, 1) + "0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n",
      {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 3u);
  EXPECT_EQ(file->mesh.attributes[0].name, "heat");
  EXPECT_EQ(file->mesh.attributes[1].name, "heat_2");
  EXPECT_EQ(file->mesh.attributes[2].name, "a,b__");
}

TEST(PlyAttributes, NumberIsLimited) {
  std::string properties = kXyz;
  std::string values;
  for (std::size_t i = 0; i <= kMaxAttributes; ++i) {
    properties += "property uchar p" + std::to_string(i) + "\n";
    values += " 1";
  }
  EXPECT_REFUSED(ReadPly(PlyHeaderText("ascii", 3, properties, 1) + "0 0 0" + values + "\n1 0 0" +
                             values + "\n0 1 0" + values + "\n3 0 1 2\n",
                         {}),
                 ErrorReason::kLimitExceeded, "65 attributes", "64");
}

TEST(PlyAttributes, BrokenValuesNameThemselves) {
  EXPECT_REFUSED(ReadPly(PlyHeaderText("ascii", 3, std::string(kXyz) + "property float heat\n", 1) +
                             "0 0 0 1\n1 0 0 warm\n0 1 0 1\n3 0 1 2\n",
                         {}),
                 ErrorReason::kMeshUnreadable, "vertex 1 of 3", "'heat'");
}

TEST(ObjAttributes, TextureCoordinatesByCornerFollowTheFans) {
  const auto file = ReadObj(
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nvt 0.5 0.25 7\nvt 1\nvt 0 1\nvn 0 0 1\n"
      "f 1/1 2/2/1 3/3 4/-3\nf 1//1 2/2 3//1\n",
      {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  ExpectAttribute(file->mesh, "uv", AttributeKind::kTextureCoordinates, 2, true,
                  {0,    0,     0, 0, 0,    0,      //
                   0.5f, 0.25f, 1, 0, 0,    1,      //
                   0.5f, 0.25f, 0, 1, 0.5f, 0.25f,  //
                   0,    0,     1, 0, 0,    0});
  EXPECT_TRUE(CheckAttributes(file->mesh).ok());
}

TEST(ObjAttributes, CoordinatesMayFollowTheirFacesAndMayBeMissingAltogether) {
  const std::string shape = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1 2/2 3/3\n";
  const auto late = ReadObj(shape + "vt 0 1\nvt 2 3\nvt 4 5\n", {});
  ASSERT_TRUE(late.ok()) << late.status();
  ExpectAttribute(late->mesh, "uv", AttributeKind::kTextureCoordinates, 2, true,
                  {0, 1, 2, 3, 4, 5});
  const auto missing = ReadObj(shape, {});
  ASSERT_TRUE(missing.ok()) << missing.status();
  EXPECT_TRUE(missing->mesh.attributes.empty());
}

TEST(ObjAttributes, BadTextureIndicesAreRefused) {
  const std::string shape = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\n";
  EXPECT_REFUSED(ReadObj(shape + "f 1/1 2/2 3/1\n", {}), ErrorReason::kMeshDegenerate, "triangle 0",
                 "texture coordinate 1", "there are 1");
  EXPECT_REFUSED(ReadObj(shape + "f 1/1 2/-2 3/1\n", {}), ErrorReason::kMeshDegenerate, "line 5",
                 "index -2 after 1 texture coordinates");
  EXPECT_REFUSED(ReadObj(shape + "f 1/1 2/x 3/1\n", {}), ErrorReason::kMeshUnreadable, "line 5",
                 "'x'");
}

TEST(ObjAttributes, ColoursBehindPositions) {
  const auto file =
      ReadObj("v 0 0 0\nv 1 0 0 0.5 0.25 0\nv 1 1 0 2\nv 0 1 0 0 0 1\nf 1 2 3 4\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  ExpectAttribute(file->mesh, "color", AttributeKind::kColor, 3, false,
                  {1, 1, 1, 0.5f, 0.25f, 0, 1, 1, 1, 0, 0, 1});
}

TEST(OffAttributes, ColoursAsBytesOrFractions) {
  const auto bytes =
      ReadOff("COFF\n3 1 0\n0 0 0 255 0 0 51\n1 0 0 0 102 0 255\n0 1 0\n3 0 1 2\n", {});
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  ExpectAttribute(bytes->mesh, "color", AttributeKind::kColor, 4, false,
                  {1, 0, 0, 0.2f, 0, 0.4f, 0, 1, 1, 1, 1, 1});
  const auto fractions = ReadOff(
      "CNOFF\n3 1 0\n0 0 0 0 0 1 0.5 0 0\n1 0 0 0 0 1 0 1 0\n0 1 0 0 0 1 0 0 1\n3 0 1 2\n", {});
  ASSERT_TRUE(fractions.ok()) << fractions.status();
  ExpectAttribute(fractions->mesh, "color", AttributeKind::kColor, 3, false,
                  {0.5f, 0, 0, 0, 1, 0, 0, 0, 1});
  const auto plain = ReadOff("OFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n3 0 1 2\n", {});
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_TRUE(plain->mesh.attributes.empty());
}

TEST(OffAttributes, TextureCoordinatesComeLast) {
  const auto plain =
      ReadOff("STOFF\n3 1 0\n0 0 0 0.5 0.25\n1 0 0\n0 1 0 -1 2 9\n3 0 1 2 0.5 0.5\n", {});
  ASSERT_TRUE(plain.ok()) << plain.status();
  ASSERT_EQ(plain->mesh.attributes.size(), 1u);
  ExpectAttribute(plain->mesh, "uv", AttributeKind::kTextureCoordinates, 2, false,
                  {0.5f, 0.25f, 0, 0, -1, 2});
  const auto all = ReadOff(
      "STCNOFF\n3 1 0\n0 0 0 9 9 9 255 0 51 102 0.5 1\n1 0 0 9 9 9 0 255 0 255 0 0.25\n"
      "0 1 0 9 9 9 0 0 255 0 1 0\n3 0 1 2\n",
      {});
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_EQ(all->mesh.attributes.size(), 2u);
  ExpectAttribute(all->mesh, "color", AttributeKind::kColor, 4, false,
                  {1, 0, 0.2f, 0.4f, 0, 1, 0, 1, 0, 0, 1, 0});
  ExpectAttribute(all->mesh, "uv", AttributeKind::kTextureCoordinates, 2, false,
                  {0.5f, 1, 0, 0.25f, 1, 0});
  // Without alpha the texture coordinates are not taken for it.
  const auto three =
      ReadOff("STCOFF\n3 1 0\n0 0 0 1 0 0 0.5 1\n1 0 0 0 1 0 0 0\n0 1 0 0 0 1 1 0\n3 0 1 2\n", {});
  ASSERT_TRUE(three.ok()) << three.status();
  ExpectAttribute(three->mesh, "color", AttributeKind::kColor, 3, false,
                  {1, 0, 0, 0, 1, 0, 0, 0, 1});
  ExpectAttribute(three->mesh, "uv", AttributeKind::kTextureCoordinates, 2, false,
                  {0.5f, 1, 0, 0, 1, 0});
}

TEST(OffAttributes, NormalsAndColoursOfFacesArePassedOver) {
  const auto file =
      ReadOff("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 255 0 0\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_TRUE(file->mesh.attributes.empty());
}

}  // namespace
}  // namespace ccst::io
