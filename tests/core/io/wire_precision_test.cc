#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/io/draco_mesh.h"
#include "core/io/numbers.h"
#include "tests/core/io/io_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

TEST(ChooseOrigin, OrdinaryMeshesStayWhereTheyAre) {
  EXPECT_EQ(ChooseOrigin(shapes::Icosphere(2)), Eigen::Vector3d::Zero());
  // The diagonal is 2 sqrt(3), so that 16 of them are 55.4.
  EXPECT_EQ(ChooseOrigin(shapes::Moved(shapes::Cube(), {54, -54, 54})), Eigen::Vector3d::Zero());
  EXPECT_EQ(ChooseOrigin({}), Eigen::Vector3d::Zero());
  TriangleMesh bad = shapes::Cube();
  bad.positions[0].x() = NAN;
  bad.positions[1].x() = INFINITY;
  EXPECT_EQ(ChooseOrigin(bad), Eigen::Vector3d::Zero());
}

TEST(ChooseOrigin, FarMeshesGetTheirCentreOnTheFarAxesOnly) {
  const Eigen::Vector3d offset(1e7, 3, -4e9);
  const Eigen::Vector3d origin = ChooseOrigin(shapes::Moved(shapes::Icosphere(2), offset));
  EXPECT_NEAR(origin.x(), 1e7, 4);
  EXPECT_EQ(origin.y(), 0);
  EXPECT_NEAR(origin.z(), -4e9, 4);
}

TEST(ChooseOrigin, MovingFloatsByItRoundsNothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-12, 25);
  for (int round = 0; round < 2000; ++round) {
    const double scale = std::exp2(exponent(random));
    const Eigen::Vector3d offset(scale * std::exp2(exponent(random)),
                                 -scale * std::exp2(exponent(random)), scale);
    TriangleMesh mesh =
        shapes::Moved(testing::WithOddCoordinates(shapes::Icosphere(0)), offset, scale);
    for (Eigen::Vector3d& position : mesh.positions) {
      for (double& coordinate : position) coordinate = io::RoundedToFloat(coordinate);
    }
    const Eigen::Vector3d origin = ChooseOrigin(mesh);
    const auto wire = ToWirePrecision(mesh, origin);
    ASSERT_TRUE(wire.ok()) << wire.status();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_EQ(mesh.positions[i], (wire->positions[i] + origin).eval());
    }
  }
}

TEST(ChooseOrigin, FarDoublesLoseUnderAMillionthOfTheDiagonal) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> exponent(-20, 30);
  for (int round = 0; round < 500; ++round) {
    const Eigen::Vector3d offset(std::exp2(exponent(random)), std::exp2(exponent(random)), 0);
    const TriangleMesh mesh =
        shapes::Moved(testing::WithOddCoordinates(shapes::Icosphere(1)), offset);
    const Eigen::Vector3d origin = ChooseOrigin(mesh);
    const auto wire = ToWirePrecision(mesh, origin);
    ASSERT_TRUE(wire.ok()) << wire.status();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_LT((mesh.positions[i] - origin - wire->positions[i]).norm(), 1e-6 * 3.4);
    }
  }
}

TEST(ToWirePrecision, IsWhatTheOtherSideDecodes) {
  const Eigen::Vector3d offset(1e7, 0, 0);
  TriangleMesh mesh = testing::Shuffled(
      shapes::Moved(testing::WithOddCoordinates(shapes::Icosphere(3)), offset), 2);
  const Eigen::Vector3d origin = ChooseOrigin(mesh);
  const auto wire = ToWirePrecision(mesh, origin);
  ASSERT_TRUE(wire.ok()) << wire.status();
  for (Eigen::Vector3d& position : mesh.positions) position -= origin;
  const auto decoded = DecodeDraco(EncodeDraco(mesh).value());
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ("", testing::Difference(*wire, *decoded));
  // Once more changes nothing.
  EXPECT_EQ("", testing::Difference(*wire, *ToWirePrecision(*wire, Eigen::Vector3d::Zero())));
}

TEST(ToWirePrecision, RefusesWhatFloatsCannotHold) {
  const TriangleMesh huge = shapes::Moved(shapes::Icosphere(1), Eigen::Vector3d::Zero(), 1e200);
  EXPECT_REFUSED(ToWirePrecision(huge, ChooseOrigin(huge)), ErrorReason::kMeshDegenerate,
                 "vertex 0", "scale the mesh down");
  const TriangleMesh tiny = shapes::Moved(shapes::Icosphere(1), Eigen::Vector3d::Zero(), 1e-41);
  EXPECT_REFUSED(ToWirePrecision(tiny, ChooseOrigin(tiny)), ErrorReason::kMeshDegenerate,
                 "scale the mesh up");
  const TriangleMesh vanishing =
      shapes::Moved(shapes::Icosphere(1), Eigen::Vector3d::Zero(), 1e-60);
  EXPECT_REFUSED(ToWirePrecision(vanishing, ChooseOrigin(vanishing)), ErrorReason::kMeshDegenerate,
                 "scale the mesh up");
  EXPECT_TRUE(ToWirePrecision(shapes::Moved(shapes::Cube(), Eigen::Vector3d::Zero(), 1e30),
                              Eigen::Vector3d::Zero())
                  .ok());
  EXPECT_TRUE(ToWirePrecision(shapes::Moved(shapes::Cube(), Eigen::Vector3d::Zero(), 1e-12),
                              Eigen::Vector3d::Zero())
                  .ok());
}

}  // namespace
}  // namespace ccst
