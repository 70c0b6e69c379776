#include "proto/convert/figures.h"

#include <numbers>

#include <gtest/gtest.h>

namespace ccst {
namespace {

TEST(ConvertFigures, AnglesAreSharesOverRadians) {
  quality::AngleFigures figures;
  figures.smallest = 45.0;
  figures.mean_smallest = 50.0;
  figures.histogram[22] = 1;
  figures.histogram[45] = 3;
  v1::AnalyzeJobResponse response;
  AddFigures(figures, response);
  EXPECT_DOUBLE_EQ(response.min_angle_radians(), std::numbers::pi / 4.0);
  EXPECT_DOUBLE_EQ(response.mean_min_angle_radians(), std::numbers::pi * 50.0 / 180.0);
  const v1::Curve& curve = response.angle_histogram();
  ASSERT_EQ(curve.x_size(), 90);
  ASSERT_EQ(curve.y_size(), 90);
  EXPECT_DOUBLE_EQ(curve.x(0), std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(curve.x(22), std::numbers::pi / 4.0);
  EXPECT_EQ(curve.y(22), 0.25);
  EXPECT_EQ(curve.y(45), 0.75);
  EXPECT_EQ(curve.y(0), 0.0);
}

TEST(ConvertFigures, CurveWithoutPlacesIsUnset) {
  analysis::SampleFigures figures;
  figures.power_spectrum = {{0.01, 0.02}, {1.0, 1.0}};
  v1::AnalyzeJobResponse response;
  AddFigures(figures, response);
  EXPECT_FALSE(response.has_radial_mean());
  EXPECT_FALSE(response.has_anisotropy());
  EXPECT_EQ(response.power_spectrum().y_size(), 2);
}

}  // namespace
}  // namespace ccst
