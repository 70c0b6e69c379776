#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/io/draco_mesh.h"
#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "core/io/sample_file.h"
#include "core/mesh/attributes.h"
#include "draco/compression/decode.h"
#include "draco/core/decoder_buffer.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using Type = draco::GeometryAttribute::Type;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Values are eighths, so that turning v over loses nothing.
std::vector<float> Eighths(std::size_t count, int start) {
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>((start += 3) % 9) / 8.0F;
  return values;
}

std::vector<Attribute> EveryKind(std::size_t rows) {
  return {{.name = "color",
           .kind = AttributeKind::kColor,
           .components = 4,
           .values = Eighths(4 * rows, 1)},
          {.name = "uv",
           .kind = AttributeKind::kTextureCoordinates,
           .components = 2,
           .values = Eighths(2 * rows, 2)},
          {.name = "heat", .values = Eighths(rows, 3)},
          {.name = "flow", .components = 3, .values = Eighths(3 * rows, 4)}};
}

TriangleMesh WithEveryKind(TriangleMesh mesh) {
  mesh.attributes = EveryKind(mesh.positions.size());
  return mesh;
}

TriangleMesh WriteAndRead(const TriangleMesh& mesh, MeshOutputFormat output, MeshFormat input) {
  const auto bytes = EncodeMesh(mesh, output);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  if (!bytes.ok()) return {};
  auto file = ReadMesh(*bytes, input);
  EXPECT_TRUE(file.ok()) << file.status();
  return file.ok() ? std::move(file->mesh) : TriangleMesh{};
}

// The first `components` numbers of the value at a corner, whatever the attribute goes by.
std::vector<float> AtCorner(const TriangleMesh& mesh, const std::string& name, std::size_t corner,
                            int components) {
  const Attribute* const attribute = FindAttribute(mesh.attributes, name);
  if (attribute == nullptr || attribute->components < components) return {};
  const auto vertex =
      static_cast<std::size_t>(mesh.faces[corner / 3][static_cast<int>(corner % 3)]);
  const std::size_t row = attribute->per_corner ? corner : vertex;
  const auto start =
      attribute->values.begin() + static_cast<std::ptrdiff_t>(row) * attribute->components;
  return std::vector<float>(start, start + components);
}

void ExpectSameAtCorners(const TriangleMesh& written, const std::string& name,
                         const TriangleMesh& read, const std::string& read_name, int components) {
  ASSERT_EQ(read.faces.size(), written.faces.size());
  ASSERT_NE(FindAttribute(read.attributes, read_name), nullptr) << read_name;
  EXPECT_EQ(FindAttribute(read.attributes, read_name)->components, components) << read_name;
  for (std::size_t c = 0; c < 3 * written.faces.size(); ++c) {
    ASSERT_EQ(AtCorner(read, read_name, c, components), AtCorner(written, name, c, components))
        << name << " at corner " << c;
  }
}

TEST(WriterAttributes, ObjHoldsColoursAndTextureCoordinates) {
  const TriangleMesh mesh = WithEveryKind(testing::WithOddCoordinates(shapes::Icosphere(1)));
  const TriangleMesh read = WriteAndRead(mesh, MeshOutputFormat::kObj, MeshFormat::kObj);
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_EQ(read.attributes.size(), 2u);
  ExpectSameAtCorners(mesh, "color", read, "color", 3);
  ExpectSameAtCorners(mesh, "uv", read, "uv", 2);
}

TEST(WriterAttributes, PlyHoldsThoseByVertex) {
  TriangleMesh mesh = WithEveryKind(testing::WithOddCoordinates(shapes::Cube()));
  mesh.attributes[0].values = {0, 1, 0.2F, 0.4F};  // Whole bytes.
  mesh.attributes[0].values.resize(32, 0.6F);
  mesh.attributes.push_back({.name = "nx", .values = Eighths(8, 5)});
  mesh.attributes.push_back({.name = "corner", .per_corner = true, .values = Eighths(36, 6)});
  const TriangleMesh read = WriteAndRead(mesh, MeshOutputFormat::kPly, MeshFormat::kPly);
  EXPECT_EQ(read.positions, mesh.positions);
  EXPECT_EQ(read.faces, mesh.faces);
  EXPECT_EQ(read.attributes.size(), 7u);
  ExpectSameAtCorners(mesh, "color", read, "color", 4);
  ExpectSameAtCorners(mesh, "uv", read, "uv", 2);
  ExpectSameAtCorners(mesh, "heat", read, "heat", 1);
  ExpectSameAtCorners(mesh, "flow", read, "flow_0", 1);
  ExpectSameAtCorners(mesh, "nx", read, "nx_2", 1);
}

TEST(WriterAttributes, DracoHoldsAll) {
  const TriangleMesh mesh = WithEveryKind(shapes::Icosphere(1));
  const TriangleMesh read = WriteAndRead(mesh, MeshOutputFormat::kDraco, MeshFormat::kDraco);
  EXPECT_EQ("", testing::Difference(read, *ToWirePrecision(mesh, Eigen::Vector3d::Zero())));
  EXPECT_EQ(read.attributes.size(), 4u);
}

TEST(WriterAttributes, GlbHoldsAll) {
  TriangleMesh mesh = WithEveryKind(shapes::Cube());
  mesh.attributes.push_back(
      {.name = "tint", .kind = AttributeKind::kColor, .components = 3, .values = Eighths(24, 5)});
  mesh.attributes.push_back({.name = "seams",
                             .kind = AttributeKind::kTextureCoordinates,
                             .components = 2,
                             .per_corner = true,
                             .values = Eighths(72, 6)});
  const TriangleMesh read = WriteAndRead(mesh, MeshOutputFormat::kGlb, MeshFormat::kGltf);
  EXPECT_EQ(read.attributes.size(), 6u);
  ExpectSameAtCorners(mesh, "color", read, "color", 4);
  ExpectSameAtCorners(mesh, "tint", read, "color_2", 3);
  ExpectSameAtCorners(mesh, "uv", read, "uv", 2);
  ExpectSameAtCorners(mesh, "seams", read, "uv_2", 2);
  ExpectSameAtCorners(mesh, "heat", read, "heat", 1);
  ExpectSameAtCorners(mesh, "flow", read, "flow", 3);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(read.positions[read.faces[f][k]], mesh.positions[mesh.faces[f][k]]);
    }
  }
}

TEST(WriterAttributes, GlbKeepsVerticesOfNoFaceAndHasFiniteNumbersOnly) {
  TriangleMesh mesh = shapes::WithIsolatedVertices(shapes::SingleTriangle(), 9);
  mesh.attributes = {{.name = "heat", .values = std::vector<float>(mesh.positions.size(), 7)}};
  const Eigen::Vector3i face = mesh.faces[0];
  mesh.attributes[0].values[static_cast<std::size_t>(face[1])] = NAN;
  mesh.attributes[0].values[static_cast<std::size_t>(face[2])] = INFINITY;
  const TriangleMesh read = WriteAndRead(mesh, MeshOutputFormat::kGlb, MeshFormat::kGltf);
  EXPECT_EQ(read.positions.size(), mesh.positions.size());
  EXPECT_THAT(read.attributes.at(0).values, ElementsAre(7, 0, 0));
}

TEST(WriterAttributes, OfTheWrongSizeAreRefused) {
  TriangleMesh mesh = WithEveryKind(shapes::Cube());
  mesh.attributes[2].values.pop_back();
  for (const auto format :
       {MeshOutputFormat::kObj, MeshOutputFormat::kPly, MeshOutputFormat::kStl,
        MeshOutputFormat::kOff, MeshOutputFormat::kDraco, MeshOutputFormat::kGlb}) {
    EXPECT_REFUSED(EncodeMesh(mesh, format), ErrorReason::kMeshDegenerate, "'heat'");
  }
}

// What a Draco point cloud of EveryKind() at these positions must hold.
void ExpectDracoCloud(const std::string& bytes, const std::vector<Eigen::Vector3d>& positions) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  auto decoded = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  ASSERT_TRUE(decoded.ok());
  const std::unique_ptr<draco::PointCloud> cloud = std::move(decoded).value();
  ASSERT_EQ(cloud->num_points(), positions.size());
  const draco::PointAttribute* const places = cloud->GetNamedAttribute(Type::POSITION);
  ASSERT_NE(places, nullptr);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    Eigen::Vector3f place;
    places->GetMappedValue(draco::PointIndex(i), place.data());
    EXPECT_EQ(place, positions[i].cast<float>());
  }
  for (const Attribute& attribute : EveryKind(positions.size())) {
    const int id = cloud->GetAttributeIdByMetadataEntry("name", attribute.name);
    ASSERT_GE(id, 0) << attribute.name;
    const draco::PointAttribute& values = *cloud->attribute(id);
    EXPECT_EQ(values.attribute_type(), attribute.name == "color" ? Type::COLOR
                                       : attribute.name == "uv"  ? Type::TEX_COORD
                                                                 : Type::GENERIC);
    ASSERT_EQ(values.num_components(), attribute.components);
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      std::array<float, 4> row = {};
      values.GetMappedValue(draco::PointIndex(i), row.data());
      for (std::size_t k = 0; k < static_cast<std::size_t>(attribute.components); ++k) {
        EXPECT_EQ(row[k], attribute.values[i * static_cast<std::size_t>(attribute.components) + k]);
      }
    }
  }
}

SampleSet ThreeSamples() {
  SampleSet samples;
  samples.faces = {0, 0, 1};
  samples.barycentrics = {{0.5, 0.25}, {0, 1}, {1, 0}};
  samples.positions = {{0.1, 2, 3}, {4, 1.0 / 3.0, 6}, {7, 8, 9}};
  samples.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  samples.attributes = EveryKind(3);
  return samples;
}

TEST(WriterAttributes, DracoSamplesHoldAll) {
  const SampleSet samples = ThreeSamples();
  const auto bytes = EncodeSamples(samples, SampleFormat::kDraco);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  ExpectDracoCloud(*bytes, samples.positions);
}

TEST(WriterAttributes, ObjSamplesHoldColoursAndTextureCoordinates) {
  const SampleSet samples = ThreeSamples();
  const auto text = EncodeSamples(samples, SampleFormat::kObj);
  ASSERT_TRUE(text.ok()) << text.status();
  // The reader wants a face.
  const auto file = ReadMesh(*text + "f 1/1 2/2 3/3\n", MeshFormat::kObj);
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.positions, samples.positions);
  const TriangleMesh expected = {samples.positions, {{0, 1, 2}}, samples.attributes};
  ExpectSameAtCorners(expected, "color", file->mesh, "color", 3);
  ExpectSameAtCorners(expected, "uv", file->mesh, "uv", 2);
}

TEST(WriterAttributes, MeshesWithoutFacesAreFilesOfPoints) {
  TriangleMesh mesh = WithEveryKind(shapes::Cube());
  mesh.faces.clear();
  const auto cloud = EncodeMesh(mesh, MeshOutputFormat::kDraco);
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  ExpectDracoCloud(*cloud, mesh.positions);

  const auto glb = EncodeMesh(mesh, MeshOutputFormat::kGlb);
  ASSERT_TRUE(glb.ok()) << glb.status();
  const auto json = nlohmann::json::parse(
      glb->substr(20, io::LoadBytes<std::uint32_t>(glb->data() + 12, std::endian::little)));
  const auto& primitive = json["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  EXPECT_FALSE(primitive.contains("indices"));
  for (const char* key : {"POSITION", "COLOR_0", "TEXCOORD_0", "_heat", "_flow"}) {
    ASSERT_TRUE(primitive["attributes"].contains(key)) << key;
    EXPECT_EQ(json["accessors"][primitive["attributes"][key].get<int>()]["count"], 8) << key;
  }

  EXPECT_THAT(EncodeMesh(mesh, MeshOutputFormat::kPly).value(), HasSubstr("element vertex 8\n"));
  EXPECT_THAT(EncodeMesh(mesh, MeshOutputFormat::kOff).value(), HasSubstr("OFF\n8 0 0\n"));
  const std::string obj = EncodeMesh(mesh, MeshOutputFormat::kObj).value();
  EXPECT_EQ(std::count(obj.begin(), obj.end(), '\n'), 16);
  EXPECT_EQ(EncodeMesh(mesh, MeshOutputFormat::kStl).value().size(), 84u);
}

TEST(WriterAttributes, NothingAtAllIsRefusedWhereTheFormatHasNoPlaceForIt) {
  EXPECT_REFUSED(EncodeMesh({}, MeshOutputFormat::kDraco), ErrorReason::kMeshEmpty, "no vertices");
  EXPECT_REFUSED(EncodeMesh({}, MeshOutputFormat::kGlb), ErrorReason::kMeshEmpty, "no vertices");
  EXPECT_TRUE(EncodeMesh({}, MeshOutputFormat::kPly).ok());
}

}  // namespace
}  // namespace ccst
