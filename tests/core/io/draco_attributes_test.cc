#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/draco_mesh.h"
#include "core/mesh/attributes.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/mesh/mesh.h"
#include "draco/mesh/triangle_soup_mesh_builder.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using testing::Difference;
using ::testing::ElementsAre;

std::vector<float> OddValues(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random()) / 3e9F;
  return values;
}

// With a colour and a scalar by vertex and texture coordinates by corner; in the latter, a seam
// runs through every third face.
TriangleMesh WithAttributes(TriangleMesh mesh) {
  const std::size_t vertices = mesh.positions.size();
  mesh.attributes.push_back({.name = "color",
                             .kind = AttributeKind::kColor,
                             .components = 4,
                             .values = OddValues(4 * vertices, 1)});
  Attribute uv{.name = "uv",
               .kind = AttributeKind::kTextureCoordinates,
               .components = 2,
               .per_corner = true};
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (const int corner : mesh.faces[f]) {
      uv.values.push_back(static_cast<float>(corner) / 7.0F);
      uv.values.push_back(f % 3 == 0 ? static_cast<float>(f) : 0.3F);
    }
  }
  mesh.attributes.push_back(uv);
  mesh.attributes.push_back({.name = "heat", .values = OddValues(vertices, 2)});
  return mesh;
}

TriangleMesh Wire(const TriangleMesh& mesh) {
  return ToWirePrecision(mesh, Eigen::Vector3d::Zero()).value();
}

TEST(DracoAttributes, WirePrecisionIsWhatIsDecodedAttributesIncluded) {
  for (const TriangleMesh& shape :
       {shapes::SingleTriangle(), shapes::Cube(), shapes::Icosphere(4),
        shapes::WithIsolatedVertices(shapes::Cube(), 5),
        shapes::WithIsolatedVertices(shapes::Cube(), 20),
        shapes::WithIsolatedVertices(shapes::Cube(), 40), shapes::ThreeFins()}) {
    const TriangleMesh mesh =
        WithAttributes(testing::Shuffled(testing::WithOddCoordinates(shape), 7));
    const auto decoded = DecodeDraco(EncodeDraco(mesh).value());
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    const TriangleMesh wire = Wire(mesh);
    EXPECT_EQ("", Difference(wire, *decoded)) << mesh.positions.size() << " vertices";
    // Once more changes nothing.
    EXPECT_EQ("", Difference(wire, Wire(wire)));
    EXPECT_EQ("", Difference(wire, DecodeDraco(EncodeDraco(wire).value()).value()));
  }
}

TEST(DracoAttributes, NothingIsLost) {
  const TriangleMesh mesh = WithAttributes(testing::Shuffled(shapes::Icosphere(3), 5));
  const auto decoded = DecodeDraco(EncodeDraco(mesh).value());
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->positions.size(), mesh.positions.size());
  EXPECT_EQ(decoded->faces, mesh.faces);
  ASSERT_EQ(decoded->attributes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(decoded->attributes[i].name, mesh.attributes[i].name);
    EXPECT_EQ(decoded->attributes[i].kind, mesh.attributes[i].kind);
    EXPECT_EQ(decoded->attributes[i].components, mesh.attributes[i].components);
    EXPECT_EQ(decoded->attributes[i].per_corner, mesh.attributes[i].per_corner);
    EXPECT_EQ(decoded->attributes[i].values, mesh.attributes[i].values);
  }
}

TEST(DracoAttributes, PositionsMayBeQuantised) {
  const TriangleMesh mesh = WithAttributes(shapes::Torus(1, 0.35, 60, 40));
  const auto decoded = DecodeDraco(EncodeDraco(mesh, 11).value());
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->positions.size(), mesh.positions.size());
  EXPECT_EQ(decoded->faces, mesh.faces);
  ASSERT_EQ(decoded->attributes.size(), 3u);
  EXPECT_EQ(decoded->attributes[1].values, mesh.attributes[1].values);
}

TEST(DracoAttributes, CornersThatAgreeBecomeVertices) {
  TriangleMesh mesh = shapes::Cube();
  Attribute by_corner{.name = "height", .per_corner = true};
  Attribute by_vertex{.name = "height"};
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const int v : face) by_corner.values.push_back(static_cast<float>(mesh.positions[v].z()));
  }
  for (const Eigen::Vector3d& p : mesh.positions) {
    by_vertex.values.push_back(static_cast<float>(p.z()));
  }
  mesh.attributes = {by_corner};
  const auto decoded = DecodeDraco(EncodeDraco(mesh).value());
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  ASSERT_EQ(decoded->attributes.size(), 1u);
  EXPECT_FALSE(decoded->attributes[0].per_corner);
  EXPECT_EQ(decoded->attributes[0].values, by_vertex.values);
  EXPECT_EQ("", Difference(Wire(mesh), *decoded));
}

TEST(DracoAttributes, ValuesMayBeAnything) {
  TriangleMesh mesh = shapes::Cube();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  mesh.attributes = {{.name = "odd", .values = {NAN, kInf, -kInf, -0.0F, 0.0F, 1e-45F, 3e38F, 1}}};
  EXPECT_EQ("", Difference(Wire(mesh), DecodeDraco(EncodeDraco(mesh).value()).value()));
}

TEST(DracoAttributes, NamesAndIdsAreThoseOfTheWire) {
  TriangleMesh mesh = shapes::SingleTriangle();
  for (const char* name : {"", "heat", "heat", "a\nb\xff"}) {
    mesh.attributes.push_back({.name = name, .values = {1, 2, 3}});
  }
  const TriangleMesh decoded = DecodeDraco(EncodeDraco(mesh).value()).value();
  std::vector<std::string> names;
  std::vector<int> ids;
  for (const Attribute& attribute : decoded.attributes) {
    names.push_back(attribute.name);
    ids.push_back(attribute.id);
  }
  EXPECT_THAT(names, ElementsAre("scalar", "heat", "heat_2", "a_b_"));
  EXPECT_THAT(ids, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ("", Difference(Wire(mesh), decoded));
}

TEST(DracoAttributes, WrongSizesAreRefused) {
  TriangleMesh mesh = shapes::Cube();
  mesh.attributes = {{.name = "heat", .values = std::vector<float>(7)}};
  EXPECT_REFUSED(EncodeDraco(mesh), ErrorReason::kMeshDegenerate, "'heat'", "7 values", "8 rows");
  EXPECT_REFUSED(ToWirePrecision(mesh, Eigen::Vector3d::Zero()), ErrorReason::kMeshDegenerate,
                 "'heat'");
  mesh.attributes.assign(65, {.name = "heat", .values = std::vector<float>(8)});
  EXPECT_REFUSED(EncodeDraco(mesh), ErrorReason::kLimitExceeded, "65 attributes");
}

// A fan around one vertex whose corners all differ: comparing each with each would take minutes.
TEST(DracoAttributes, ManyCornersAtAVertexTakeLittleTime) {
  TriangleMesh mesh;
  constexpr int kFaces = 200'000;
  mesh.positions.emplace_back(0, 0, 1);
  for (int i = 0; i <= kFaces; ++i) mesh.positions.emplace_back(std::cos(i), std::sin(i), 0);
  for (int i = 1; i <= kFaces; ++i) mesh.faces.emplace_back(0, i, i + 1);
  mesh.attributes = {
      {.name = "odd", .per_corner = true, .values = OddValues(3 * std::size_t{kFaces}, 3)}};
  EXPECT_EQ("", Difference(Wire(mesh), DecodeDraco(EncodeDraco(mesh).value()).value()));
}

// What other programs write: Edgebreaker with seams, colours in bytes, a name and none.
TEST(DracoAttributes, OfOtherEncodersByNameAndByUniqueId) {
  const TriangleMesh shape = shapes::PlaneGrid(1, 1, 8, 8);
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(shape.faces.size()));
  using Attribute = draco::GeometryAttribute;
  const int position = builder.AddAttribute(Attribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(Attribute::COLOR, 3, draco::DT_UINT8);
  const int uv = builder.AddAttribute(Attribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const int heat = builder.AddAttribute(Attribute::GENERIC, 1, draco::DT_FLOAT32);
  const int nameless = builder.AddAttribute(Attribute::GENERIC, 1, draco::DT_INT32);
  for (std::uint32_t f = 0; f < shape.faces.size(); ++f) {
    const draco::FaceIndex face(f);
    Eigen::Vector3f p[3];
    std::array<std::uint8_t, 3> c[3];
    Eigen::Vector2f t[3];
    float h[3];
    std::int32_t n[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = shape.positions[shape.faces[f][k]].cast<float>();
      c[k] = {static_cast<std::uint8_t>(255 * p[k].x()), 51, 0};
      // A seam between the halves.
      t[k] = {p[k].x(), p[k].y() + (f < shape.faces.size() / 2 ? 0.0F : 5.0F)};
      h[k] = 10 * p[k].x() - p[k].y();
      n[k] = static_cast<std::int32_t>(1000 * p[k].y());
    }
    builder.SetAttributeValuesForFace(position, face, p[0].data(), p[1].data(), p[2].data());
    builder.SetAttributeValuesForFace(color, face, c[0].data(), c[1].data(), c[2].data());
    builder.SetAttributeValuesForFace(uv, face, t[0].data(), t[1].data(), t[2].data());
    builder.SetAttributeValuesForFace(heat, face, &h[0], &h[1], &h[2]);
    builder.SetAttributeValuesForFace(nameless, face, &n[0], &n[1], &n[2]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  ASSERT_NE(mesh, nullptr);
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  metadata->AddEntryString("name", "heat");
  mesh->AddAttributeMetadata(heat, std::move(metadata));
  draco::ExpertEncoder encoder(*mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(encoder.EncodeToBuffer(&buffer).ok());

  const auto decoded = DecodeDraco({buffer.data(), buffer.size()});
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->positions.size(), shape.positions.size());
  ASSERT_EQ(decoded->attributes.size(), 4u);
  const auto* found_color = FindAttribute(decoded->attributes, "color");
  const auto* found_uv = FindAttribute(decoded->attributes, "uv");
  const auto* found_heat = FindAttribute(decoded->attributes, "heat");
  const auto* found_nameless =
      FindAttribute(decoded->attributes, "attribute_" + std::to_string(nameless));
  ASSERT_TRUE(found_color && found_uv && found_heat && found_nameless);
  EXPECT_EQ(found_heat->id, static_cast<int>(mesh->attribute(heat)->unique_id()));
  EXPECT_TRUE(found_uv->per_corner);
  EXPECT_FALSE(found_color->per_corner);
  EXPECT_FALSE(found_heat->per_corner);
  for (std::size_t v = 0; v < decoded->positions.size(); ++v) {
    const Eigen::Vector3f p = decoded->positions[v].cast<float>();
    EXPECT_EQ(found_heat->values[v], 10 * p.x() - p.y());
    EXPECT_EQ(found_nameless->values[v], std::trunc(1000 * p.y()));
    EXPECT_FLOAT_EQ(found_color->values[3 * v], std::trunc(255 * p.x()) / 255);
    EXPECT_FLOAT_EQ(found_color->values[3 * v + 1], 0.2F);
  }
  for (std::size_t c = 0; c < 3 * decoded->faces.size(); ++c) {
    const Eigen::Vector3d& p = decoded->positions[decoded->faces[c / 3][c % 3]];
    EXPECT_EQ(found_uv->values[2 * c], static_cast<float>(p.x()));
    const float offset = found_uv->values[2 * c + 1] - static_cast<float>(p.y());
    EXPECT_TRUE(std::abs(offset) < 1e-5F || std::abs(offset - 5) < 1e-5F) << offset;
  }
  EXPECT_TRUE(CheckAttributes(*decoded).ok());
}

// Draco's own reading of them is undefined for bytes other than 0 and 1.
TEST(DracoAttributes, OfTruthValuesAreZeroOrOneWhateverTheirBytes) {
  draco::Mesh mesh;
  mesh.set_num_points(3);
  const auto add = [&mesh](draco::GeometryAttribute::Type type, draco::DataType data_type,
                           int components, const std::vector<std::uint8_t>& bytes) {
    draco::GeometryAttribute attribute;
    const int stride = components * draco::DataTypeLength(data_type);
    attribute.Init(type, nullptr, static_cast<std::int8_t>(components), data_type, false, stride,
                   0);
    const int id = mesh.AddAttribute(attribute, true, 3);
    for (std::uint32_t i = 0; i < 3; ++i) {
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                            bytes.data() + i * static_cast<std::size_t>(stride));
    }
  };
  const auto encoded = [&mesh] {
    mesh.SetNumFaces(1);
    mesh.SetFace(draco::FaceIndex(0),
                 {draco::PointIndex(0), draco::PointIndex(1), draco::PointIndex(2)});
    draco::ExpertEncoder encoder(mesh);
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
    return std::string(buffer.data(), buffer.size());
  };
  add(draco::GeometryAttribute::POSITION, draco::DT_UINT8, 3, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  add(draco::GeometryAttribute::GENERIC, draco::DT_BOOL, 1, {0, 3, 255});
  const auto decoded = DecodeDraco(encoded());
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_THAT(decoded->attributes.at(0).values, ElementsAre(0, 1, 1));

  mesh.DeleteAttribute(1);
  mesh.DeleteAttribute(0);
  add(draco::GeometryAttribute::POSITION, draco::DT_BOOL, 3, {0, 0, 0, 3, 0, 0, 0, 1, 0});
  EXPECT_REFUSED(DecodeDraco(encoded()), ErrorReason::kDracoDecodeFailed, "position 0");
}

TEST(DracoAttributes, DamagedStreamsGiveAMeshOrARefusal) {
  const std::string bytes = EncodeDraco(WithAttributes(shapes::Icosphere(1))).value();
  std::mt19937 random(9);
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
    const auto mesh = DecodeDraco(damaged);
    if (mesh.ok()) {
      EXPECT_TRUE(CheckAttributes(*mesh).ok());
      for (const Eigen::Vector3i& face : mesh->faces) {
        ASSERT_GE(face.minCoeff(), 0);
        ASSERT_LT(face.maxCoeff(), static_cast<int>(mesh->positions.size()));
      }
    } else {
      EXPECT_TRUE(GetErrorReason(mesh.status()).has_value());
    }
  }
}

}  // namespace
}  // namespace ccst
