// Streams made to take more than they give. Each is refused, and refusing it takes little memory.
#include <chrono>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "core/io/draco_mesh.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/mesh/mesh.h"
#include "draco/mesh/triangle_soup_mesh_builder.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

constexpr std::int64_t kMiB = 1 << 20;
// Room for counts that only the plausibility checks can stop.
constexpr MeshLimits kGenerous = {.max_vertices = std::int64_t{1} << 40,
                                  .max_faces = std::int64_t{1} << 40,
                                  .max_decoded_bytes = std::int64_t{1} << 40};

std::string Varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 128; value >>= 7) bytes += static_cast<char>(value | 128);
  return bytes + static_cast<char>(value);
}

std::string Header(int method) {
  return std::string("DRACO\2\2\1", 8) + static_cast<char>(method) + std::string(2, '\0');
}

std::string EdgebreakerClaim(int traversal, std::uint64_t faces, int attributes = 0) {
  return Header(1) + static_cast<char>(traversal) + Varint(faces / 2) + Varint(faces) +
         static_cast<char>(attributes) + Varint(faces) + Varint(0);
}

std::string SequentialClaim(std::uint64_t faces, std::uint64_t points, bool compressed) {
  return Header(0) + Varint(faces) + Varint(points) + (compressed ? '\0' : '\1');
}

void ExpectCheapRefusal(std::string bytes, std::size_t size, std::int64_t most_bytes,
                        const std::string& name) {
  bytes.resize(std::max(size, bytes.size()), '\0');
  EXPECT_FALSE(DecodeDraco(bytes, kGenerous).ok()) << name;
  const std::int64_t growth = testing::PeakGrowth([&] { (void)DecodeDraco(bytes, kGenerous); });
  EXPECT_GE(growth, 0) << name << " crashed";
  EXPECT_LT(growth, most_bytes) << name;
}

TEST(DracoHostile, HugeCountsInNinetyBytesTakeNoMemory) {
  for (const std::uint64_t faces : {std::uint64_t{1'000'000}, std::uint64_t{40'000'000},
                                    std::uint64_t{1'400'000'000}, std::uint64_t{0xffffffff}}) {
    const std::string name = std::to_string(faces);
    ExpectCheapRefusal(EdgebreakerClaim(0, faces), 90, 4 * kMiB, "standard " + name);
    ExpectCheapRefusal(EdgebreakerClaim(1, faces), 90, 4 * kMiB, "predictive " + name);
    ExpectCheapRefusal(EdgebreakerClaim(2, faces), 90, 4 * kMiB, "valence " + name);
    ExpectCheapRefusal(SequentialClaim(faces, faces / 2, false), 90, 4 * kMiB, "raw " + name);
    ExpectCheapRefusal(SequentialClaim(faces, faces / 2, true), 90, 4 * kMiB, "coded " + name);
    ExpectCheapRefusal(SequentialClaim(1, faces, false) + std::string("\0\1\2", 3), 90, 4 * kMiB,
                       "points " + name);
  }
}

TEST(DracoHostile, CountsUnderTheBudgetTakeNoMoreThanIt) {
  for (const int traversal : {1, 2}) {
    ExpectCheapRefusal(EdgebreakerClaim(traversal, 340'000), 90, 48 * kMiB, "edgebreaker");
  }
  ExpectCheapRefusal(SequentialClaim(1, 500'000, false) + std::string("\0\1\2", 3), 90, 48 * kMiB,
                     "points");
}

TEST(DracoHostile, ManySeamConnectivitiesAreCounted) {
  ExpectCheapRefusal(EdgebreakerClaim(2, 340'000, 255), 1000, 4 * kMiB, "seams");
}

TEST(DracoHostile, WideAttributesAreRefusedBeforeTheirValues) {
  constexpr int kAttributes = 100;
  constexpr std::size_t kFaces = 140'000;
  std::string bytes = SequentialClaim(kFaces, 400'000, false) + std::string(3 * kFaces, '\0');
  bytes += '\1';                 // One decoder...
  bytes += Varint(kAttributes);  // ... of this many attributes,
  for (int i = 0; i < kAttributes; ++i) {
    // each generic (4), of 255 doubles (10), not normalised, with an id.
    bytes += std::string("\4\12\377\0", 4) + Varint(static_cast<std::uint64_t>(i));
  }
  bytes += std::string(kAttributes, '\0');  // Plain values.
  EXPECT_REFUSED(DecodeDraco(bytes, kGenerous), ErrorReason::kDracoDecodeFailed,
                 "100 attributes of 400000 points");
  EXPECT_REFUSED(DecodeDraco(bytes), ErrorReason::kLimitExceeded, "MiB");
  ExpectCheapRefusal(bytes, 0, 48 * kMiB, "wide attributes");
}

// Textured, quantised: the decoder takes the prediction of texture coordinates from the stream.
std::string TexturedStream() {
  const TriangleMesh shape = shapes::Icosphere(2);
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(shape.faces.size()));
  const int position =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int texture =
      builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (std::uint32_t i = 0; i < shape.faces.size(); ++i) {
    std::array<Eigen::Vector3f, 3> p;
    std::array<Eigen::Vector2f, 3> t;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = static_cast<std::size_t>(shape.faces[i][static_cast<int>(k)]);
      p[k] = shape.positions[vertex].cast<float>();
      t[k] = {std::atan2(p[k].y(), p[k].x()), p[k].z() + 0.5f * static_cast<float>(i % 2)};
    }
    const draco::FaceIndex face(i);
    builder.SetAttributeValuesForFace(position, face, p[0].data(), p[1].data(), p[2].data());
    builder.SetAttributeValuesForFace(texture, face, t[0].data(), t[1].data(), t[2].data());
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::ExpertEncoder encoder(*mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(0, 0);
  encoder.SetAttributeQuantization(0, 11);
  encoder.SetAttributeQuantization(1, 10);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return std::string(buffer.data(), buffer.size());
}

TEST(DracoHostile, BillionsOfOrientationsAreRefusedAtOnce) {
  const std::string valid = TexturedStream();
  ASSERT_TRUE(DecodeDraco(valid).ok()) << DecodeDraco(valid).status();
  // The count's place is not known from outside: put a huge number at every place.
  int refused_for_it = 0;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t at = 11; at + 4 <= valid.size(); ++at) {
    std::string bytes = valid;
    bytes.replace(at, 4, "\xff\xff\xff\x7f");
    const auto result = DecodeDraco(bytes);
    if (result.ok()) continue;
    refused_for_it += result.status().ToString().find("orientations") != std::string::npos;
  }
  EXPECT_GE(refused_for_it, 1);
  // One of them decoded takes 20 s alone; all of these take well under a second.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));
}

std::vector<std::string> ValidStreams() {
  std::vector<std::string> streams = {TexturedStream()};
  const TriangleMesh mesh = shapes::Icosphere(1);
  streams.push_back(EncodeDraco(mesh).value());
  streams.push_back(EncodeDraco(mesh, 8).value());
  return streams;
}

TEST(DracoHostile, EveryTruncationIsRefused) {
  for (const std::string& whole : ValidStreams()) {
    for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
      const auto result = DecodeDraco(std::span(whole).first(size));
      // The tail may be padding, or one that the entropy coder never reads.
      if (result.ok()) {
        EXPECT_GT(size, whole.size() / 2);
      } else {
        EXPECT_REFUSED(result, ErrorReason::kDracoDecodeFailed);
      }
    }
  }
}

TEST(DracoHostile, DamagedBytesGiveAMeshOrARefusal) {
  const std::vector<std::string> streams = ValidStreams();
  const auto run = [&] {
    std::mt19937 random(20120);
    for (int round = 0; round < 6000; ++round) {
      std::string bytes = streams[static_cast<std::size_t>(round) % streams.size()];
      for (auto changes = 1 + random() % 6; changes > 0; --changes) {
        const std::size_t range = random() % 3 == 0 ? 120 : bytes.size();
        bytes[random() % std::min(range, bytes.size())] = static_cast<char>(random());
      }
      const auto result = DecodeDraco(bytes);
      if (result.ok()) {
        const auto count = static_cast<int>(result->positions.size());
        for (const Eigen::Vector3i& face : result->faces) {
          if (face.minCoeff() < 0 || face.maxCoeff() >= count) _exit(3);
        }
      } else if (!GetErrorReason(result.status()).has_value()) {
        _exit(4);
      }
    }
  };
  const std::int64_t growth = testing::PeakGrowth(run);
  EXPECT_GE(growth, 0);
  EXPECT_LT(growth, 64 * kMiB);
}

}  // namespace
}  // namespace ccst
