#include <algorithm>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_readers.h"
#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

using ::testing::ElementsAre;

constexpr char kBody[] = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST(OffReader, HeadersInEveryForm) {
  for (const char* header :
       {"OFF\n3 1 0\n", "OFF 3 1 0\n", "OFF3 1 0\n", "OFF\n\n# note\n3 1 3 # counts\n",
        "OFF\n3 1\n", "COFF\n3 1 0\n", "NOFF\n3 1 0\n", "STOFF\n3 1 0\n", "STCNOFF\n3 1 0\n"}) {
    const auto file = ReadOff(std::string(header) + kBody, {});
    ASSERT_TRUE(file.ok()) << header << file.status();
    EXPECT_EQ(file->mesh.positions.size(), 3u) << header;
    EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2))) << header;
  }
}

TEST(OffReader, WhatFollowsOnALineIsPassedOver) {
  const auto file = ReadOff(
      "COFF\n3 1 0\n0 0 0 255 0 0 255\n# between\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n"
      "3 0 1 2 0.5 0.5 0.5\n",
      {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.positions[2], Eigen::Vector3d(0, 1, 0));
}

TEST(OffReader, PolygonsBecomeTrianglesThatKnowTheirFace) {
  const auto file =
      ReadOff("OFF\n5 2 0\n0 0 0\n1 0 0\n2 1 0\n1 2 0\n0 1 0\n5 0 1 2 3 4\n3 0 1 2\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.faces.size(), 4u);
  EXPECT_EQ(file->mesh.faces[3], Eigen::Vector3i(0, 1, 2));
  std::vector<int> corners(5, 0);
  for (int f = 0; f < 3; ++f) {
    for (const int corner : file->mesh.faces[f]) ++corners[corner];
  }
  EXPECT_EQ(std::accumulate(corners.begin(), corners.end(), 0), 9);
  EXPECT_EQ(std::count(corners.begin(), corners.end(), 0), 0);
  EXPECT_THAT(file->face_source, ElementsAre(0, 0, 0, 1));
}

TEST(OffReader, SyntaxErrorsNameTheLine) {
  EXPECT_REFUSED(ReadOff("PLY\n3 1 0\n", {}), ErrorReason::kMeshUnreadable, "line 1", "'PLY'");
  EXPECT_REFUSED(ReadOff("OFF BINARY\n", {}), ErrorReason::kMeshUnreadable, "binary OFF");
  EXPECT_REFUSED(ReadOff("OFF BINARY\n" + std::string(40, '\x07'), {}),
                 ErrorReason::kMeshUnreadable, "not the records");
  EXPECT_REFUSED(ReadOff("OFF\nthree 1 0\n", {}), ErrorReason::kMeshUnreadable, "line 2",
                 "vertices", "'three'");
  EXPECT_REFUSED(ReadOff("OFF\n3 -1 0\n", {}), ErrorReason::kMeshUnreadable, "line 2", "'-1'");
  EXPECT_REFUSED(ReadOff("OFF\n3 1 0\n0 0 0\n1 O 0\n", {}), ErrorReason::kMeshUnreadable, "line 4",
                 "vertex 1 of 3", "'O'");
  EXPECT_REFUSED(ReadOff("OFF\n3 1 0\n0 0 0\n", {}), ErrorReason::kMeshUnreadable,
                 "the end of the file");
}

TEST(OffReader, BadContentNamesTheCulprit) {
  EXPECT_REFUSED(ReadOff("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {}),
                 ErrorReason::kMeshDegenerate, "line 6", "face 0", "vertex 3", "3 vertices");
  EXPECT_REFUSED(ReadOff("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -2\n", {}),
                 ErrorReason::kMeshDegenerate, "line 6", "vertex -2");
  EXPECT_REFUSED(ReadOff("OFF\n1 1 0\n0 0 inf\n3 0 0 0\n", {}), ErrorReason::kMeshDegenerate,
                 "line 3", "vertex 0", "z = inf");
  EXPECT_REFUSED(ReadOff("OFF\n1 0 0\n0 0 0\n", {}), ErrorReason::kMeshEmpty, "1 vertices");
}

TEST(OffReader, AnnouncedCountsAreHeldAgainstLimitsAndBytes) {
  EXPECT_REFUSED(ReadOff("OFF\n4 1 0\n", {.max_vertices = 3}), ErrorReason::kLimitExceeded,
                 "4 vertices");
  EXPECT_REFUSED(ReadOff("OFF\n4 5 0\n", {.max_faces = 4}), ErrorReason::kLimitExceeded, "5 faces");
  EXPECT_REFUSED(ReadOff("OFF\n1 1 0\n0 0 0\n2000000000 0\n", {}), ErrorReason::kMeshUnreadable,
                 "number of corners of face 0");
  const MeshLimits generous = {.max_vertices = std::int64_t{1} << 40,
                               .max_faces = std::int64_t{1} << 40};
  const auto growth = testing::PeakGrowth(
      [&] { (void)ReadOff("OFF\n1000000000000 1000000000000 0\n0 0 0\n", generous); });
  EXPECT_GE(growth, 0);
  EXPECT_LT(growth, 8 << 20);
}

}  // namespace
}  // namespace ccst::io
