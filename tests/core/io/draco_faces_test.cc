// Which face of its file each triangle of a Draco stream was cut from.
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/draco_names.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/mesh/mesh.h"
#include "draco/metadata/geometry_metadata.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

std::string Encode(const std::vector<std::int32_t>& face_source) {
  return EncodeDraco(shapes::Cube(), std::nullopt, face_source).value();
}

// One triangle with these bytes as its entry, by Draco's own encoder.
std::string TriangleWith(const std::vector<std::uint8_t>& entry) {
  draco::Mesh mesh;
  mesh.set_num_points(3);
  draco::GeometryAttribute position;
  position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int id = mesh.AddAttribute(position, true, 3);
  const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int i = 0; i < 3; ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), corners[i]);
  }
  mesh.AddFace({draco::PointIndex(0), draco::PointIndex(1), draco::PointIndex(2)});
  mesh.AddMetadata(std::make_unique<draco::GeometryMetadata>());
  mesh.metadata()->AddEntryBinary(io::kDracoFacesEntry, entry);
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST(DracoFaceSource, ComesBackAsItWasGiven) {
  const std::vector<std::vector<std::int32_t>> sources = {
      {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5},                     // Quads.
      {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},                   // Triangles.
      {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},                     // One polygon.
      {3, 3, 3, 7, 8, 8, 9, 9, 9, 9, 1'000'000, 2'147'483'647}  // Faces left out between.
  };
  for (const std::vector<std::int32_t>& source : sources) {
    const auto back = DracoFaceSource(Encode(source));
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(*back, source);
  }
}

TEST(DracoFaceSource, RandomOnesComeBackToo) {
  std::mt19937 random(5);
  for (int run = 0; run < 50; ++run) {
    std::vector<std::int32_t> source = {static_cast<std::int32_t>(random() % 3)};
    while (source.size() < 12) {
      source.push_back(source.back() + static_cast<std::int32_t>(random() % 4));
    }
    EXPECT_EQ(*DracoFaceSource(Encode(source)), source);
  }
}

TEST(DracoFaceSource, StreamWithoutItHasNone) { EXPECT_TRUE(DracoFaceSource(Encode({}))->empty()); }

TEST(DracoFaceSource, OneThatFallsIsNotWritten) {
  EXPECT_TRUE(DracoFaceSource(Encode({1, 0, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2}))->empty());
}

TEST(DracoFaceSource, ChangesNothingElseOfTheMesh) {
  const TriangleMesh with = *DecodeDraco(Encode({0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5}));
  const TriangleMesh without = *DecodeDraco(Encode({}));
  EXPECT_EQ(with.positions, without.positions);
  EXPECT_EQ(with.faces, without.faces);
}

TEST(DracoFaceSource, ForeignMetadataIsReadAsWritten) {
  EXPECT_EQ(*DracoFaceSource(TriangleWith({6, 1, 1})), std::vector<std::int32_t>{5});
}

TEST(DracoFaceSource, DamagedEntriesAreRefused) {
  const std::vector<std::vector<std::uint8_t>> entries = {
      {1},                                  // Ends within a run.
      {1, 1, 2},                            // More triangles than there are.
      {1, 0, 1},                            // A face of none.
      {0, 1, 1},                            // Face -1.
      {1, 1, 0},                            // No face.
      {0xff, 0xff, 0xff, 0xff, 0x0f, 1, 1}  // Beyond 31 bits.
  };
  for (const std::vector<std::uint8_t>& entry : entries) {
    const auto source = DracoFaceSource(TriangleWith(entry));
    EXPECT_EQ(GetErrorReason(source.status()), ErrorReason::kDracoDecodeFailed)
        << ::testing::PrintToString(entry);
  }
}

}  // namespace
}  // namespace ccst
