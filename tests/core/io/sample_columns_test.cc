#include "core/io/sample_columns.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "core/io/sample_file.h"
#include "tests/core/io/io_test_util.h"

namespace ccst {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> Names(const std::vector<Attribute>& attributes) {
  std::vector<std::string> names;
  for (const io::SampleColumn& column : io::LayOutColumns(attributes, {"x", "y", "z"}))
    names.push_back(column.name);
  return names;
}

TEST(SampleColumns, HaveTheNamesThatOtherProgramsKnow) {
  EXPECT_THAT(
      Names({{.name = "color", .kind = AttributeKind::kColor, .components = 4},
             {.name = "uv", .kind = AttributeKind::kTextureCoordinates, .components = 2},
             {.name = "heat"},
             {.name = "flow", .components = 3}}),
      ElementsAre("red", "green", "blue", "alpha", "s", "t", "heat", "flow_0", "flow_1", "flow_2"));
}

TEST(SampleColumns, NamesArePlainAndUnique) {
  EXPECT_THAT(Names({{.name = "x"},
                     {.name = "a b,c\"d\n"},
                     {.name = "a_b_c_d_"},
                     {.name = "s"},
                     {.name = "uv", .kind = AttributeKind::kTextureCoordinates, .components = 2},
                     {.name = "c", .kind = AttributeKind::kColor, .components = 3},
                     {.name = "d", .kind = AttributeKind::kColor, .components = 3}}),
              ElementsAre("x_2", "a_b_c_d_", "a_b_c_d__2", "s", "s_2", "t", "red", "green", "blue",
                          "red_2", "green_2", "blue_2"));
}

TEST(SampleColumns, BytesAreClampedAndRounded) {
  EXPECT_EQ(io::ToByte(0.0F), 0);
  EXPECT_EQ(io::ToByte(1.0F), 255);
  EXPECT_EQ(io::ToByte(0.2F), 51);
  EXPECT_EQ(io::ToByte(-3.0F), 0);
  EXPECT_EQ(io::ToByte(7.0F), 255);
  EXPECT_EQ(io::ToByte(NAN), 0);
  EXPECT_EQ(io::ToByte(std::numeric_limits<float>::infinity()), 255);
}

SampleSet TwoSamples() {
  SampleSet samples;
  samples.faces = {4, 5};
  samples.barycentrics = {{0.5, 0.25}, {0, 1}};
  samples.positions = {{1, 2, 3}, {4, 5, 6}};
  samples.normals = {{0, 0, 1}, {0, 1, 0}};
  samples.attributes = {{.name = "color",
                         .kind = AttributeKind::kColor,
                         .components = 3,
                         .values = {1, 0.2F, 0, 0.1F, 2, -1}},
                        {.name = "uv",
                         .kind = AttributeKind::kTextureCoordinates,
                         .components = 2,
                         .values = {0.1F, 0.25F, -1, 3}},
                        {.name = "heat", .values = {1e-30F, 37.5F}}};
  return samples;
}

TEST(SampleColumns, CsvHoldsEveryBit) {
  EXPECT_EQ(EncodeSamples(TwoSamples(), SampleFormat::kCsv).value(),
            "x,y,z,nx,ny,nz,face,bary_u,bary_v,red,green,blue,s,t,heat\n"
            "1,2,3,0,0,1,4,0.5,0.25,1,0.2,0,0.1,0.25,1e-30\n"
            "4,5,6,0,1,0,5,0,1,0.1,2,-1,-1,3,37.5\n");
}

TEST(SampleColumns, PlyHasBytesForColoursAndFloatsForTheRest) {
  const std::string bytes = EncodeSamples(TwoSamples(), SampleFormat::kPly).value();
  const std::size_t start = bytes.find("end_header\n") + 11;
  EXPECT_NE(bytes.find("property double bary_v\nproperty uchar red\nproperty uchar green\n"
                       "property uchar blue\nproperty float s\nproperty float t\n"
                       "property float heat\nend_header\n"),
            std::string::npos);
  ASSERT_EQ(bytes.size(), start + 2 * (56 + 3 + 12));
  const char* const record = bytes.data() + start + 56 + 3 + 12 + 56;
  EXPECT_EQ(static_cast<unsigned char>(record[0]), 26);
  EXPECT_EQ(static_cast<unsigned char>(record[1]), 255);
  EXPECT_EQ(static_cast<unsigned char>(record[2]), 0);
  EXPECT_EQ(io::LoadBytes<float>(record + 3, std::endian::little), -1.0F);
  EXPECT_EQ(io::LoadBytes<float>(record + 7, std::endian::little), 3.0F);
  EXPECT_EQ(io::LoadBytes<float>(record + 11, std::endian::little), 37.5F);
}

TEST(SampleColumns, AttributesOfTheWrongLengthAreRefused) {
  SampleSet samples = TwoSamples();
  samples.attributes[1].values.pop_back();
  EXPECT_REFUSED(EncodeSamples(samples, SampleFormat::kPly), ErrorReason::kOptionInvalid, "'uv'",
                 "3 values", "2 samples");
}

}  // namespace
}  // namespace ccst
