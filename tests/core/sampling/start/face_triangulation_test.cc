#include "core/sampling/start/face_triangulation.h"

#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/random/random.h"
#include "core/sampling/mesh/faults.h"
#include "tests/core/sampling/sampling_test_util.h"

namespace ccst::internal {
namespace {

const std::vector<Eigen::Vector3d> kCorners = {{1, 0, 0}, {0, 2, 0}, {0, 0, 1}};

Eigen::Vector3d RandomPoint(std::uint64_t i) {
  const CounterRandom random(4, 4);
  Eigen::Vector2d at(random.Uniform(2 * i), random.Uniform(2 * i + 1));
  if (at.sum() > 1.0) at = Eigen::Vector2d::Ones() - at;
  return kCorners[0] + at[0] * (kCorners[1] - kCorners[0]) + at[1] * (kCorners[2] - kCorners[0]);
}

TEST(FaceTriangulation, PointsGiveTwoTrianglesEach) {
  FaceTriangulation face;
  face.Start(kCorners);
  for (std::uint64_t i = 0; i < 200; ++i) face.Insert(RandomPoint(i));
  EXPECT_EQ(face.mesh().triangle_count(), 401);
  EXPECT_EQ(FindFault(face.mesh()), "");
  for (std::int32_t v = 0; v < 203; ++v) EXPECT_EQ(face.mesh().IsBoundary(v), v < 3);
}

TEST(FaceTriangulation, TrianglesCoverTheFaceOnce) {
  std::vector<Eigen::Vector3d> place = kCorners;
  FaceTriangulation face;
  face.Start(place);
  for (std::uint64_t i = 0; i < 200; ++i) {
    place.push_back(RandomPoint(i));
    face.Insert(place.back());
  }
  const Eigen::Vector3d up = (place[1] - place[0]).cross(place[2] - place[0]);
  double sum = 0.0;
  for (const Eigen::Vector3i& t : sampling_test::Triangles(face.mesh())) {
    const double area = (place[t[1]] - place[t[0]]).cross(place[t[2]] - place[t[0]]).dot(up);
    EXPECT_GT(area, 0.0);
    sum += area;
  }
  EXPECT_NEAR(sum, up.squaredNorm(), 1e-12);
}

// A face cut in three by two samples on its side.
TEST(FaceTriangulation, VerticesOfTheOutlineAreNotJoined) {
  std::vector<Eigen::Vector3d> place = kCorners;
  place.push_back(0.7 * kCorners[0] + 0.3 * kCorners[1]);
  place.push_back(0.3 * kCorners[0] + 0.7 * kCorners[1]);
  FaceTriangulation face;
  face.Start(place, {{0, 3, 2}, {3, 4, 2}, {4, 1, 2}});
  for (std::uint64_t i = 0; i < 50; ++i) face.Insert(RandomPoint(i));
  EXPECT_EQ(FindFault(face.mesh()), "");
  EXPECT_LT(face.mesh().FindEdge(0, 4), 0);
  EXPECT_LT(face.mesh().FindEdge(3, 1), 0);
  EXPECT_LT(face.mesh().FindEdge(0, 1), 0);
}

TEST(FaceTriangulation, FaceWithoutAreaTakesPoints) {
  FaceTriangulation face;
  face.Start({kCorners[0], kCorners[1], kCorners[0]});
  for (int i = 0; i < 20; ++i) face.Insert(kCorners[0] + 0.05 * i * (kCorners[1] - kCorners[0]));
  EXPECT_EQ(face.mesh().triangle_count(), 41);
  EXPECT_EQ(FindFault(face.mesh()), "");
}

}  // namespace
}  // namespace ccst::internal
