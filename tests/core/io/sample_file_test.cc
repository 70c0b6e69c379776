#include "core/io/sample_file.h"

#include <cstring>
#include <sstream>

#include <gtest/gtest.h>

#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "draco/compression/decode.h"
#include "draco/core/decoder_buffer.h"
#include "tests/core/io/io_test_util.h"

namespace ccst {
namespace {

SampleSet ThreeSamples() {
  SampleSet samples;
  samples.faces = {7, 0, 2147483647};
  samples.barycentrics = {{0.1, 0.2}, {1.0 / 3.0, 5e-324}, {-0.0, 1}};
  samples.positions = {{0.1, -0.2, 1e300}, {1.0 / 3.0, 2e-300, -0.0}, {1, 2, 3}};
  samples.normals = {{0, 0, 1}, {0.6, -0.8, 0}, {1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0}};
  samples.triangles = {{0, 1, 2}};
  return samples;
}

std::vector<std::vector<std::string>> Rows(const std::string& text, char separator) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, separator);) rows.back().push_back(cell);
  }
  return rows;
}

void ExpectSameBits(double a, const std::string& text) {
  const auto b = io::ParseDouble(text);
  ASSERT_TRUE(b.has_value()) << text;
  EXPECT_EQ(0, std::memcmp(&a, &*b, sizeof(a))) << text;
}

TEST(SampleFormat, FollowsTheExtensionInAnyCase) {
  EXPECT_EQ(SampleFormatFromPath("a.ply"), SampleFormat::kPly);
  EXPECT_EQ(SampleFormatFromPath("a.CSV"), SampleFormat::kCsv);
  EXPECT_EQ(SampleFormatFromPath("a.b/c.xyz"), SampleFormat::kXyz);
  EXPECT_EQ(SampleFormatFromPath("a.obj"), SampleFormat::kObj);
  EXPECT_EQ(SampleFormatFromPath("a.drc"), SampleFormat::kDraco);
  EXPECT_FALSE(SampleFormatFromPath("a.stl").has_value());
  EXPECT_FALSE(SampleFormatFromPath("-").has_value());
}

TEST(SampleFile, CsvHoldsEveryBit) {
  const SampleSet samples = ThreeSamples();
  const auto text = EncodeSamples(samples, SampleFormat::kCsv);
  ASSERT_TRUE(text.ok()) << text.status();
  const auto rows = Rows(*text, ',');
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(text->substr(0, text->find('\n')), "x,y,z,nx,ny,nz,face,bary_u,bary_v");
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = rows[i + 1];
    ASSERT_EQ(row.size(), 9u);
    for (std::size_t k = 0; k < 3; ++k) {
      ExpectSameBits(samples.positions[i][static_cast<int>(k)], row[k]);
      ExpectSameBits(samples.normals[i][static_cast<int>(k)], row[k + 3]);
    }
    EXPECT_EQ(row[6], std::to_string(samples.faces[i]));
    ExpectSameBits(samples.barycentrics[i].x(), row[7]);
    ExpectSameBits(samples.barycentrics[i].y(), row[8]);
  }
}

TEST(SampleFile, XyzAndObjHoldEveryBitOfPositions) {
  const SampleSet samples = ThreeSamples();
  const auto xyz = Rows(EncodeSamples(samples, SampleFormat::kXyz).value(), ' ');
  const auto obj = Rows(EncodeSamples(samples, SampleFormat::kObj).value(), ' ');
  ASSERT_EQ(xyz.size(), 3u);
  ASSERT_EQ(obj.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(xyz[i].size(), 3u);
    ASSERT_EQ(obj[i].size(), 4u);
    EXPECT_EQ(obj[i][0], "v");
    for (std::size_t k = 0; k < 3; ++k) {
      ExpectSameBits(samples.positions[i][static_cast<int>(k)], xyz[i][k]);
      EXPECT_EQ(xyz[i][k], obj[i][k + 1]);
    }
  }
}

TEST(SampleFile, PlyHoldsEveryBit) {
  const SampleSet samples = ThreeSamples();
  const auto bytes = EncodeSamples(samples, SampleFormat::kPly);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const std::string end = "end_header\n";
  const std::size_t start = bytes->find(end) + end.size();
  EXPECT_EQ(bytes->substr(0, start),
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
            "property double x\nproperty double y\nproperty double z\n"
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property int face\nproperty double bary_u\nproperty double bary_v\nend_header\n");
  ASSERT_EQ(bytes->size(), start + 3 * 56);
  for (std::size_t i = 0; i < 3; ++i) {
    const char* record = bytes->data() + start + 56 * i;
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(io::LoadBytes<double>(record + 8 * k, std::endian::little),
                samples.positions[i][k]);
      EXPECT_EQ(io::LoadBytes<float>(record + 24 + 4 * k, std::endian::little),
                static_cast<float>(samples.normals[i][k]));
    }
    EXPECT_EQ(io::LoadBytes<std::int32_t>(record + 36, std::endian::little), samples.faces[i]);
    EXPECT_EQ(io::LoadBytes<double>(record + 40, std::endian::little), samples.barycentrics[i].x());
    EXPECT_EQ(io::LoadBytes<double>(record + 48, std::endian::little), samples.barycentrics[i].y());
  }
}

TEST(SampleFile, DracoHoldsFloatsInOrder) {
  SampleSet samples = ThreeSamples();
  EXPECT_FALSE(EncodeSamples(samples, SampleFormat::kDraco).ok());  // 1e300 is no float.
  samples.positions[0].z() = 4;
  const auto bytes = EncodeSamples(samples, SampleFormat::kDraco);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  draco::DecoderBuffer buffer;
  buffer.Init(bytes->data(), bytes->size());
  auto cloud = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  ASSERT_TRUE(cloud.ok());
  const auto& points = *std::move(cloud).value();
  ASSERT_EQ(points.num_points(), 3u);
  for (const auto& [type, vectors] :
       {std::pair{draco::GeometryAttribute::POSITION, samples.positions},
        std::pair{draco::GeometryAttribute::NORMAL, samples.normals}}) {
    const draco::PointAttribute* attribute = points.GetNamedAttribute(type);
    ASSERT_NE(attribute, nullptr);
    for (std::uint32_t i = 0; i < 3; ++i) {
      Eigen::Vector3f value;
      attribute->GetMappedValue(draco::PointIndex(i), value.data());
      EXPECT_EQ(value, vectors[i].cast<float>());
    }
  }
  // And the mesh reader says what it is.
  EXPECT_REFUSED(ReadMesh(*bytes, MeshFormat::kDraco), ErrorReason::kDracoDecodeFailed,
                 "point cloud");
}

TEST(SampleFile, NoSamplesAreAFileTooWhereTheFormatHasOne) {
  for (const SampleFormat format :
       {SampleFormat::kPly, SampleFormat::kCsv, SampleFormat::kXyz, SampleFormat::kObj}) {
    EXPECT_TRUE(EncodeSamples({}, format).ok());
  }
  EXPECT_REFUSED(EncodeSamples({}, SampleFormat::kDraco), ErrorReason::kOptionInvalid, "Draco");
}

TEST(SampleFile, ArraysOfUnequalLengthAreRefused) {
  SampleSet samples = ThreeSamples();
  samples.normals.pop_back();
  EXPECT_REFUSED(EncodeSamples(samples, SampleFormat::kXyz), ErrorReason::kOptionInvalid,
                 "3 positions, 2 normals");
}

TEST(SampleFile, IsWrittenInTheFormatOfItsNameOrTheOneGiven) {
  const testing::TemporaryFolder folder;
  const SampleSet samples = ThreeSamples();
  ASSERT_TRUE(WriteSamplesFile(samples, folder / "s.csv").ok());
  EXPECT_EQ(testing::ReadBytes(folder / "s.csv"), *EncodeSamples(samples, SampleFormat::kCsv));
  ASSERT_TRUE(WriteSamplesFile(samples, folder / "s.csv", SampleFormat::kXyz).ok());
  EXPECT_EQ(testing::ReadBytes(folder / "s.csv"), *EncodeSamples(samples, SampleFormat::kXyz));
  EXPECT_REFUSED(WriteSamplesFile(samples, folder / "s.txt"), ErrorReason::kOptionInvalid, "s.txt",
                 ".csv");
}

TEST(SampleFile, StandardOutputNeedsAFormat) {
  EXPECT_REFUSED(WriteSamplesFile(ThreeSamples(), "-"), ErrorReason::kOptionInvalid,
                 "standard output");
  ::testing::internal::CaptureStdout();
  EXPECT_TRUE(WriteSamplesFile(ThreeSamples(), "-", SampleFormat::kXyz).ok());
  EXPECT_EQ(::testing::internal::GetCapturedStdout(),
            *EncodeSamples(ThreeSamples(), SampleFormat::kXyz));
}

}  // namespace
}  // namespace ccst
