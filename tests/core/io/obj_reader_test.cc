#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/mesh_readers.h"
#include "tests/core/io/io_test_util.h"

namespace ccst::io {
namespace {

using ::testing::ElementsAre;

constexpr char kSquare[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(ObjReader, EveryKindOfCornerAndStatement) {
  const auto file = ReadObj(
      "# a comment\nmtllib x.mtl\no thing\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\n\tv\t1  1 0\n"
      "v 0 1 0\nvt 0 0\nvn 0 0 1\nusemtl m\ns off\nf 1 2 3\nf 1/1 3/1 4/1\nf 1//1 2//1 3//1\n"
      "f 1/1/1 2/1/1 4/1/1\r\nl 1 2\n",
      {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.positions.size(), 4u);
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 2, 3),
                                            Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 1, 3)));
  EXPECT_TRUE(file->face_source.empty());
}

TEST(ObjReader, PolygonsBecomeFansThatKnowTheirFace) {
  const auto file = ReadObj(std::string(kSquare) + "f 1 2 3\nf 1 2 3 4\nf 2 3 4\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(0, 1, 2),
                                            Eigen::Vector3i(0, 2, 3), Eigen::Vector3i(1, 2, 3)));
  EXPECT_THAT(file->face_source, ElementsAre(0, 1, 1, 2));
}

TEST(ObjReader, NegativeIndicesCountBackFromTheLatestVertex) {
  const auto file = ReadObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -1 -2 -3\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2), Eigen::Vector3i(3, 2, 1)));
}

TEST(ObjReader, VerticesMayFollowTheirFaces) {
  const auto file = ReadObj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->mesh.faces.size(), 1u);
}

TEST(ObjReader, JoinedLines) {
  const auto file = ReadObj(std::string(kSquare) + "f 1 2 \\\n 3\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_THAT(file->mesh.faces, ElementsAre(Eigen::Vector3i(0, 1, 2)));
}

TEST(ObjReader, BadIndicesAreRefusedWithTheirLine) {
  const std::string square = kSquare;
  EXPECT_REFUSED(ReadObj(square + "f 1 2 3\nf 1 2 5\n", {}), ErrorReason::kMeshDegenerate, "line 6",
                 "face 1", "vertex 4", "4 vertices");
  EXPECT_REFUSED(ReadObj(square + "f 1 2 3\nf 1 2 0\n", {}), ErrorReason::kMeshDegenerate, "line 6",
                 "index 0");
  EXPECT_REFUSED(ReadObj(square + "f 1 2 -5\n", {}), ErrorReason::kMeshDegenerate, "line 5",
                 "index -5");
  EXPECT_REFUSED(ReadObj(square + "f 1 2 99999999999\n", {}), ErrorReason::kMeshDegenerate,
                 "line 5");
  EXPECT_REFUSED(ReadObj(square + "f 1 2 x\n", {}), ErrorReason::kMeshUnreadable, "line 5", "'x'");
}

TEST(ObjReader, BadVerticesAreRefusedWithTheirLine) {
  EXPECT_REFUSED(ReadObj("v 0 0\nf 1 1 1\n", {}), ErrorReason::kMeshUnreadable, "line 1",
                 "three numbers");
  EXPECT_REFUSED(ReadObj("v 0 0 zero\n", {}), ErrorReason::kMeshUnreadable, "line 1", "'zero'");
  EXPECT_REFUSED(ReadObj("v 0 0 0\nv 0 nan 0\nv 1 0 0\nf 1 2 3\n", {}),
                 ErrorReason::kMeshDegenerate, "line 2", "vertex 1", "y = nan");
  EXPECT_REFUSED(ReadObj("v 0 0 1e400\nv 0 0 0\nv 1 0 0\nf 1 2 3\n", {}),
                 ErrorReason::kMeshDegenerate, "z = inf");
}

TEST(ObjReader, VerticesOfNoFaceMayBeAnything) {
  const auto file = ReadObj("v nan 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 inf 0\nf 2 3 4\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->report.vertices_not_finite, 2);
  EXPECT_EQ(file->mesh.positions.size(), 5u);
  for (const Eigen::Vector3d& position : file->mesh.positions) EXPECT_TRUE(position.allFinite());
}

TEST(ObjReader, FacesOfTooFewCornersAreSkippedButKeepTheirNumber) {
  const auto file = ReadObj(std::string(kSquare) + "f 1 2\nf 1 2 3\nf 4\nf 1 3 4\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  EXPECT_EQ(file->report.faces_skipped, 2);
  EXPECT_THAT(file->face_source, ElementsAre(1, 3));
}

TEST(ObjReader, ColoursAboveOneAreBytes) {
  const auto file = ReadObj("v 0 0 0 255 0 51\nv 1 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n", {});
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->mesh.attributes.size(), 1u);
  EXPECT_THAT(file->mesh.attributes[0].values, ElementsAre(1, 0, 0.2f, 1, 1, 1, 0, 0, 0));
}

TEST(ObjReader, OtherFilesAreRefused) {
  EXPECT_REFUSED(ReadObj("# nothing\n", {}), ErrorReason::kMeshEmpty, "no faces");
  EXPECT_REFUSED(ReadObj(std::string_view("\x7f\x45\0\x01", 4), {}), ErrorReason::kMeshUnreadable,
                 "line 1");
}

TEST(ObjReader, LimitsHold) {
  EXPECT_REFUSED(ReadObj(std::string(kSquare) + "f 1 2 3\n", {.max_vertices = 3}),
                 ErrorReason::kLimitExceeded, "line 4", "3 vertices");
  EXPECT_REFUSED(ReadObj(std::string(kSquare) + "f 1 2 3 4\n", {.max_faces = 1}),
                 ErrorReason::kLimitExceeded, "line 5", "1 triangles");
}

}  // namespace
}  // namespace ccst::io
