#include "core/io/draco_announced.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "core/io/draco_mesh.h"
#include "draco/compression/decode.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/mesh/triangle_soup_mesh_builder.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst::io {
namespace {

using testing::ReadBytes;

// How a stream is encoded.
struct Encoding {
  int method = draco::MESH_EDGEBREAKER_ENCODING;
  int speed = 5;  // 0: valence traversal and coded indices; 10: what is fastest.
  bool quantized = true;
  int attributes = 2;  // Beside positions: texture coordinates, normals, generic ones in turn.
  bool seams = false;
};

// A torus of `cells` squared quads by Draco's own encoder.
std::string Encode(int cells, const Encoding& encoding) {
  const TriangleMesh shape = shapes::Torus(2.0, 0.7, cells, cells);
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(shape.faces.size()));
  using Type = draco::GeometryAttribute;
  const int positions = builder.AddAttribute(Type::POSITION, 3, draco::DT_FLOAT32);
  constexpr std::array<std::pair<Type::Type, int>, 3> kKinds = {
      {{Type::TEX_COORD, 2}, {Type::NORMAL, 3}, {Type::GENERIC, 4}}};
  std::vector<int> ids;
  for (int a = 0; a < encoding.attributes; ++a) {
    const auto& [type, components] = kKinds[static_cast<std::size_t>(a) % kKinds.size()];
    ids.push_back(
        builder.AddAttribute(type, static_cast<std::int8_t>(components), draco::DT_FLOAT32));
  }
  for (std::uint32_t f = 0; f < shape.faces.size(); ++f) {
    std::array<Eigen::Vector3f, 3> corners;
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] =
          shape.positions[static_cast<std::size_t>(shape.faces[f][k])].cast<float>();
    }
    const draco::FaceIndex face(f);
    builder.SetAttributeValuesForFace(positions, face, corners[0].data(), corners[1].data(),
                                      corners[2].data());
    for (std::size_t a = 0; a < ids.size(); ++a) {
      std::array<Eigen::Vector4f, 3> values;
      for (std::size_t k = 0; k < 3; ++k) {
        const Eigen::Vector3f unit = corners[k].normalized();
        const float step = encoding.seams ? 0.1F * static_cast<float>(f % 5) : 0.0F;
        values[k] << unit + Eigen::Vector3f::Constant(step), 1.0F;
      }
      builder.SetAttributeValuesForFace(ids[a], face, values[0].data(), values[1].data(),
                                        values[2].data());
    }
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::ExpertEncoder encoder(*mesh);
  encoder.SetEncodingMethod(encoding.method);
  encoder.SetSpeedOptions(encoding.speed, encoding.speed);
  for (int a = 0; encoding.quantized && a < mesh->num_attributes(); ++a) {
    encoder.SetAttributeQuantization(a, 12);
  }
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return {buffer.data(), buffer.size()};
}

std::vector<Encoding> Encodings() {
  std::vector<Encoding> encodings;
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    for (const int speed : {0, 3, 5, 10}) {
      for (const bool quantized : {false, true}) {
        for (const int attributes : {0, 1, 4}) {
          for (const bool seams : {false, true}) {
            encodings.push_back({method, speed, quantized, attributes, seams});
          }
        }
      }
    }
  }
  return encodings;
}

// What Draco itself says of the attributes once it has decoded them.
std::vector<std::tuple<int, int, int>> DecodedAttributes(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  std::vector<std::tuple<int, int, int>> attributes;
  if (!mesh.ok()) return attributes;
  for (int i = 0; i < mesh.value()->num_attributes(); ++i) {
    const draco::PointAttribute& attribute = *mesh.value()->attribute(i);
    attributes.emplace_back(attribute.attribute_type(), attribute.num_components(),
                            draco::DataTypeLength(attribute.data_type()));
  }
  return attributes;
}

void ExpectTableOfTheDecoder(const std::string& bytes, const std::string& name) {
  const auto announced = ReadDracoAnnouncement(SourceOf(bytes), {});
  ASSERT_TRUE(announced.ok()) << name << ": " << announced.status();
  std::vector<std::tuple<int, int, int>> listed;
  for (const DracoListedAttribute& attribute : announced->attributes) {
    listed.emplace_back(attribute.type, attribute.components, attribute.number_bytes);
  }
  EXPECT_EQ(listed, DecodedAttributes(bytes)) << name;
}

// The meshes that others' encoders made, of all versions of the format.
std::vector<std::string> SharedStreams() {
  std::vector<std::string> files;
  const char* const set = std::getenv("CCST_SHARED_MESHES");
  const std::filesystem::path folder =
      (set != nullptr ? std::string(set) : std::string(CCST_SOURCE_DIR) + "/../shared/meshes") +
      std::string("/draco");
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".drc") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(DracoAnnouncement, TableIsThatOfTheDecoderForEveryEncoding) {
  int number = 0;
  for (const Encoding& encoding : Encodings()) {
    ExpectTableOfTheDecoder(Encode(20, encoding), "encoding " + std::to_string(number++));
  }
  ExpectTableOfTheDecoder(*EncodeDraco(shapes::Cube()), "our own");
}

TEST(DracoAnnouncement, TableIsThatOfTheDecoderForEveryVersion) {
  const std::vector<std::string> files = SharedStreams();
  if (files.empty()) GTEST_SKIP() << "there are no shared meshes";
  int meshes = 0;
  for (const std::string& file : files) {
    const std::string bytes = ReadBytes(file);
    if (!DecodeDraco(bytes).ok()) continue;
    ExpectTableOfTheDecoder(bytes, file);
    ++meshes;
  }
  EXPECT_GT(meshes, 10);
}

TEST(DracoAnnouncement, WhatDecodesIsAnnouncedWhateverBytesAreChanged) {
  std::mt19937 random(1);
  std::vector<std::string> streams;
  for (const Encoding& encoding : Encodings()) streams.push_back(Encode(5, encoding));
  for (const std::string& file : SharedStreams()) {
    if (std::string bytes = ReadBytes(file); bytes.size() < 5000) streams.push_back(bytes);
  }
  int decoded = 0;
  for (const std::string& stream : streams) {
    for (int round = 0; round < 40; ++round) {
      std::string bytes = stream;
      for (int k = 0; k < 2; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
      if (round % 8 == 0) bytes.resize(random() % bytes.size());
      const auto announced = ReadDracoAnnouncement(SourceOf(bytes), {});
      if (!DecodeDraco(bytes).ok()) continue;
      EXPECT_TRUE(announced.ok()) << announced.status();
      ++decoded;
    }
  }
  EXPECT_GT(decoded, 1000);
}

TEST(DracoAnnouncement, ConnectivityIsPassedOverUnread) {
  const std::string bytes = *EncodeDraco(shapes::Torus(2.0, 0.7, 200, 200));
  std::int64_t read = 0;
  const ByteSource counting = {.size = static_cast<std::int64_t>(bytes.size()),
                               .read = [&](std::int64_t offset, std::span<char> out) {
                                 read += static_cast<std::int64_t>(out.size());
                                 return SourceOf(bytes).read(offset, out);
                               }};
  ASSERT_TRUE(ReadDracoAnnouncement(counting, {}).ok());
  EXPECT_LT(read, 100'000);
  EXPECT_GT(bytes.size(), 500'000u);
}

TEST(DracoAnnouncement, FailureOfTheSourceIsPassedOn) {
  const std::string bytes = *EncodeDraco(shapes::Cube());
  for (int good = 0; good < 2; ++good) {
    int reads = 0;
    const ByteSource broken = {.size = static_cast<std::int64_t>(bytes.size()),
                               .read = [&](std::int64_t offset, std::span<char> out) {
                                 if (reads++ >= good) return absl::DataLossError("no disk");
                                 return SourceOf(bytes).read(offset, out);
                               }};
    EXPECT_EQ(ReadDracoAnnouncement(broken, {}).status(), absl::DataLossError("no disk")) << good;
  }
}

TEST(DracoAnnouncement, LimitsOfCountsNameThemselves) {
  const std::string bytes = *EncodeDraco(shapes::Cube());
  const absl::Status faces = ReadDracoAnnouncement(SourceOf(bytes), {.max_faces = 11}).status();
  EXPECT_EQ(GetErrorReason(faces), ErrorReason::kLimitExceeded);
  ASSERT_TRUE(GetPassedLimit(faces).has_value());
  EXPECT_EQ(GetPassedLimit(faces)->name, "max_face_count");
  EXPECT_EQ(GetPassedLimit(faces)->value, 11);
  EXPECT_EQ(GetPassedLimit(faces)->requested, 12);
  const absl::Status vertices =
      ReadDracoAnnouncement(SourceOf(bytes), {.max_vertices = 7}).status();
  ASSERT_TRUE(GetPassedLimit(vertices).has_value());
  EXPECT_EQ(GetPassedLimit(vertices)->name, "max_vertex_count");
}

TEST(DracoAnnouncement, DecodingTakesWhatIsEstimated) {
  for (const Encoding& encoding : Encodings()) {
    const std::string bytes = Encode(150, encoding);
    const DracoMemory memory = MemoryOf(*ReadDracoAnnouncement(SourceOf(bytes), {}));
    const std::int64_t growth = testing::PeakGrowth([&] { (void)DecodeDraco(bytes); });
    ASSERT_GE(growth, 0);
    // A process grows by whole pages, and the allocator keeps some at hand.
    EXPECT_LT(static_cast<double>(growth), 1.5 * static_cast<double>(memory.total()) + 2e6)
        << encoding.method << " speed " << encoding.speed << " quantized " << encoding.quantized
        << " attributes " << encoding.attributes << " seams " << encoding.seams;
  }
}

TEST(DracoAnnouncement, AttributesOfAMeshAreCounted) {
  TriangleMesh mesh = shapes::Torus(2.0, 0.7, 50, 50);
  const auto total = [&mesh] {
    return MemoryOf(*ReadDracoAnnouncement(SourceOf(*EncodeDraco(mesh)), {}));
  };
  const DracoMemory bare = total();
  EXPECT_EQ(bare.sample_bytes, 0);
  for (int a = 0; a < 40; ++a) {
    mesh.attributes.push_back({.name = "a" + std::to_string(a),
                               .components = 4,
                               .values = std::vector<float>(4 * mesh.positions.size(), 1.0F)});
  }
  const DracoMemory many = total();
  const auto values = static_cast<std::int64_t>(40 * 4 * sizeof(float) * mesh.positions.size());
  EXPECT_EQ(many.mesh_bytes - bare.mesh_bytes, values);
  EXPECT_GE(many.decoder_bytes - bare.decoder_bytes, values);
  EXPECT_EQ(many.sample_bytes, 40 * 4 * static_cast<std::int64_t>(sizeof(float)));
}

}  // namespace
}  // namespace ccst::io
