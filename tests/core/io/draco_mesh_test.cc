#include "core/io/draco_mesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/io/draco_header.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/mesh/mesh.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using testing::Difference;

TriangleMesh WireMesh(const TriangleMesh& mesh) {
  return ToWirePrecision(mesh, Eigen::Vector3d::Zero()).value();
}

TEST(EncodeDraco, KeepsFacesVerticesAndEveryBitOfFloats) {
  for (const TriangleMesh& shape :
       {shapes::SingleTriangle(), shapes::Cube(), shapes::Icosphere(2), shapes::Icosphere(5),
        shapes::Torus(1, 0.35, 300, 250), shapes::MoebiusStrip(40, 3), shapes::ThreeFins(),
        shapes::Unwelded(shapes::Icosphere(3))}) {
    const TriangleMesh mesh = testing::Shuffled(testing::WithOddCoordinates(shape), 11);
    const auto bytes = EncodeDraco(mesh);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto back = DecodeDraco(*bytes);
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ("", Difference(WireMesh(mesh), *back)) << mesh.faces.size() << " faces";
  }
}

TEST(EncodeDraco, KeepsOrderAtEveryIndexWidth) {
  for (const int vertices : {255, 256, 257, 65535, 65536, 65537}) {
    const TriangleMesh mesh =
        testing::Shuffled(shapes::WithIsolatedVertices(shapes::Icosphere(vertices < 1000 ? 2 : 6),
                                                       vertices - (vertices < 1000 ? 162 : 40962)),
                          3);
    ASSERT_EQ(mesh.positions.size(), static_cast<std::size_t>(vertices));
    const auto back = DecodeDraco(EncodeDraco(mesh).value());
    ASSERT_TRUE(back.ok()) << vertices << back.status();
    EXPECT_EQ("", Difference(WireMesh(mesh), *back)) << vertices;
  }
}

TEST(EncodeDraco, KeepsDegenerateAndRepeatedFaces) {
  TriangleMesh mesh = shapes::Cube();
  mesh.faces.emplace_back(0, 0, 1);
  mesh.faces.emplace_back(mesh.faces[3]);
  mesh.faces.emplace_back(2, 2, 2);
  mesh.positions.push_back(mesh.positions[0]);
  mesh.positions[1].z() = -0.0;
  const auto back = DecodeDraco(EncodeDraco(mesh).value());
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ("", Difference(WireMesh(mesh), *back));
}

TEST(EncodeDraco, MoreVerticesThanCornersLoseThoseOfNoFace) {
  // The cube has 36 corners: 36 vertices stay, of 37 only the cube's own do.
  const TriangleMesh fits = shapes::WithIsolatedVertices(shapes::Cube(), 28);
  EXPECT_EQ(WireMesh(fits).positions.size(), 36u);
  EXPECT_EQ("", Difference(WireMesh(fits), DecodeDraco(EncodeDraco(fits).value()).value()));
  const TriangleMesh exceeds = shapes::WithIsolatedVertices(shapes::Cube(), 29);
  EXPECT_EQ("", Difference(shapes::Cube(), DecodeDraco(EncodeDraco(exceeds).value()).value()));
  EXPECT_EQ("", Difference(shapes::Cube(), WireMesh(exceeds)));
}

TEST(EncodeDraco, QuantisationIsWithinItsStepAndKeepsFaces) {
  const TriangleMesh mesh = testing::Shuffled(shapes::Torus(1, 0.35, 200, 100), 4);
  std::size_t last_size = 0;
  for (const int bits : {1, 8, 11, 14, 20, 24}) {
    const auto bytes = EncodeDraco(mesh, bits);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    EXPECT_GE(bytes->size(), last_size);
    last_size = bytes->size();
    const auto back = DecodeDraco(*bytes);
    ASSERT_TRUE(back.ok()) << bits << " bits: " << back.status();
    EXPECT_EQ(mesh.faces, back->faces);
    // The longest side is 2.7; floats add their own rounding.
    const double step = 2.7 / (std::exp2(bits) - 1) / 2 + 1e-6;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_LE((mesh.positions[i] - back->positions[i]).cwiseAbs().maxCoeff(), step) << bits;
    }
  }
  EXPECT_LT(EncodeDraco(mesh, 11)->size(), EncodeDraco(mesh)->size() * 0.7);
}

TEST(EncodeDraco, QuantisedStripsAndPointsDecode) {
  // Strips compress so well that decoders would take the stream for truncated.
  const TriangleMesh strip = shapes::PlaneGrid(1000, 1, 20000, 1);
  const auto back = DecodeDraco(EncodeDraco(strip, 11).value());
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(strip.faces, back->faces);
  TriangleMesh point = shapes::Cube();
  for (Eigen::Vector3d& position : point.positions) position = {1, 2, 3};
  const auto collapsed = DecodeDraco(EncodeDraco(point, 8).value());
  ASSERT_TRUE(collapsed.ok()) << collapsed.status();
  EXPECT_EQ("", Difference(point, *collapsed));
}

TEST(EncodeDraco, RefusesWhatItCannotHold) {
  EXPECT_REFUSED(EncodeDraco({}), ErrorReason::kMeshEmpty);
  EXPECT_REFUSED(EncodeDraco(shapes::Cube(), 0), ErrorReason::kOptionInvalid, "[1, 24]");
  EXPECT_REFUSED(EncodeDraco(shapes::Cube(), 25), ErrorReason::kOptionInvalid, "25");
  TriangleMesh mesh = shapes::Cube();
  mesh.positions[4].x() = 3.5e38;
  EXPECT_REFUSED(EncodeDraco(mesh), ErrorReason::kMeshDegenerate, "vertex 4");
  mesh = shapes::Cube();
  mesh.faces[7][2] = -1;
  EXPECT_REFUSED(EncodeDraco(mesh), ErrorReason::kMeshDegenerate, "face 7");
}

// What other encoders make of a mesh.
struct Encoding {
  int method;
  int submethod;
  int speed;
  int bits;
  bool normals;
};

std::string EncodeElsewhere(const TriangleMesh& mesh, const Encoding& encoding) {
  draco::Mesh draco_mesh;
  const auto count = static_cast<std::uint32_t>(mesh.positions.size());
  draco_mesh.set_num_points(count);
  const auto add = [&](draco::GeometryAttribute::Type type) {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    const int id = draco_mesh.AddAttribute(attribute, true, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Eigen::Vector3f value = mesh.positions[i].cast<float>();
      draco_mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), value.data());
    }
  };
  add(draco::GeometryAttribute::POSITION);
  if (encoding.normals) add(draco::GeometryAttribute::NORMAL);
  for (const Eigen::Vector3i& face : mesh.faces) {
    draco::Mesh::Face indices;
    for (int k = 0; k < 3; ++k) indices[k] = static_cast<std::uint32_t>(face[k]);
    draco_mesh.AddFace(indices);
  }
  draco::ExpertEncoder encoder(draco_mesh);
  encoder.SetEncodingMethod(encoding.method);
  if (encoding.submethod >= 0) encoder.SetEncodingSubmethod(encoding.submethod);
  encoder.SetSpeedOptions(encoding.speed, encoding.speed);
  if (encoding.bits > 0) encoder.SetAttributeQuantization(0, encoding.bits);
  if (encoding.normals) encoder.SetAttributeQuantization(1, 8);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return std::string(buffer.data(), buffer.size());
}

// Faces by their corners' positions, however they are ordered, numbered and turned.
std::multiset<std::array<double, 9>> Geometry(const TriangleMesh& mesh) {
  std::multiset<std::array<double, 9>> faces;
  for (const Eigen::Vector3i& face : mesh.faces) {
    std::array<double, 9> least;
    for (int turn = 0; turn < 3; ++turn) {
      std::array<double, 9> corners;
      for (int k = 0; k < 9; ++k) {
        const int corner = face[(k / 3 + turn) % 3];
        corners[static_cast<std::size_t>(k)] =
            mesh.positions[static_cast<std::size_t>(corner)][k % 3];
      }
      if (turn == 0 || corners < least) least = corners;
    }
    faces.insert(least);
  }
  return faces;
}

TEST(DecodeDraco, ReadsEveryMethodOfOtherEncoders) {
  for (const TriangleMesh& shape :
       {shapes::Icosphere(3), shapes::Torus(1, 0.35, 60, 40), shapes::Cylinder(1, 2, 40, 20)}) {
    const TriangleMesh mesh = WireMesh(testing::WithOddCoordinates(shape));
    for (const int speed : {0, 3, 5, 7, 10}) {
      for (const bool normals : {false, true}) {
        const Encoding encodings[] = {
            {draco::MESH_SEQUENTIAL_ENCODING, -1, speed, 0, normals},
            {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_EDGEBREAKER_STANDARD_ENCODING, speed, 0,
             normals},
            {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_EDGEBREAKER_VALENCE_ENCODING, speed, 0,
             normals},
        };
        for (const Encoding& encoding : encodings) {
          const auto back = DecodeDraco(EncodeElsewhere(mesh, encoding));
          ASSERT_TRUE(back.ok()) << back.status();
          EXPECT_EQ(Geometry(mesh), Geometry(*back));
        }
      }
    }
  }
}

TEST(DecodeDraco, RegularMeshesThatCompressBestAreNotRefused) {
  for (const TriangleMesh& mesh :
       {shapes::PlaneGrid(1, 1, 300, 300), shapes::PlaneGrid(1000, 1, 100000, 1),
        shapes::Torus(1, 0.35, 300, 200)}) {
    for (const int bits : {8, 11}) {
      const std::string bytes =
          EncodeElsewhere(mesh, {draco::MESH_EDGEBREAKER_ENCODING,
                                 draco::MESH_EDGEBREAKER_VALENCE_ENCODING, 0, bits, false});
      const auto back = DecodeDraco(bytes);
      ASSERT_TRUE(back.ok()) << bytes.size() << " bytes: " << back.status();
      EXPECT_EQ(back->faces.size(), mesh.faces.size());
    }
  }
}

TEST(DecodeDraco, BytesBehindTheMeshAreIgnored) {
  const auto back = DecodeDraco(EncodeDraco(shapes::Cube()).value() + "behind");
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->faces, shapes::Cube().faces);
}

TEST(DecodeDraco, LimitsHoldForWhatIsRead) {
  const std::string bytes = EncodeDraco(shapes::Cube()).value();
  EXPECT_TRUE(DecodeDraco(bytes, {.max_vertices = 8, .max_faces = 12}).ok());
  EXPECT_REFUSED(DecodeDraco(bytes, {.max_vertices = 7}), ErrorReason::kLimitExceeded, "8 vertices",
                 "at most 7");
  EXPECT_REFUSED(DecodeDraco(bytes, {.max_faces = 11}), ErrorReason::kLimitExceeded, "12 faces");
  EXPECT_REFUSED(DecodeDraco(bytes, {.max_bytes = 20}), ErrorReason::kLimitExceeded, "bytes");
}

}  // namespace
}  // namespace ccst
