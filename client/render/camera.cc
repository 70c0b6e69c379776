#include "client/render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace ccst {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kFieldOfView =
    26.0 * kDegree;                          // Of the shorter side: a long lens distorts little.
constexpr double kMargin = 0.06;             // Share of the picture left free on each side.
constexpr double kAzimuth = 28.0 * kDegree;  // From the front, about the upright axis.
constexpr double kFlatness = 0.15;  // Thinnest extent over the middle one of a flat object.

constexpr double kLength = 1.5;  // Depth over width of an object that is turned sideways.

struct View {
  int up_axis;
  bool is_sideways;  // Seen from the second of the other two axes instead of the first.
  double elevation;  // Above the horizon.
};

View ChooseView(const Eigen::Vector3d& extent) {
  int thinnest = 0;
  extent.minCoeff(&thinnest);
  Eigen::Vector3d sorted = extent;
  std::sort(sorted.data(), sorted.data() + 3);
  const bool is_flat = sorted[0] < kFlatness * sorted[1] && sorted[1] > kFlatness * sorted[2];
  const int up = is_flat ? thinnest : 1;
  const bool is_sideways = extent[(up + 1) % 3] > kLength * extent[(up + 2) % 3];
  return {up, is_sideways, (is_flat ? 52.0 : 20.0) * kDegree};
}

}  // namespace

Camera Camera::Framing(std::span<const Eigen::Vector3d> positions, int width, int height) {
  Camera camera;
  if (positions.empty()) return camera;
  Eigen::Vector3d low = positions.front();
  Eigen::Vector3d high = positions.front();
  for (const Eigen::Vector3d& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // Halved before they are combined: the sum of two huge coordinates may overflow.
  camera.center_ = 0.5 * low + 0.5 * high;
  const Eigen::Vector3d extent = high - low;
  const double largest = extent.maxCoeff();
  camera.inverse_extent_ = largest > 0.0 && std::isfinite(1.0 / largest) ? 1.0 / largest : 1.0;

  const View view = ChooseView(extent * camera.inverse_extent_);
  const Eigen::Vector3d up = Eigen::Vector3d::Unit(view.up_axis);
  const Eigen::Vector3d front =
      Eigen::Vector3d::Unit((view.up_axis + (view.is_sideways ? 2 : 1)) % 3);
  const Eigen::Vector3d side = up.cross(front);
  const Eigen::Vector3d backward =
      std::cos(view.elevation) * (std::cos(kAzimuth) * front + std::sin(kAzimuth) * side) +
      std::sin(view.elevation) * up;
  const Eigen::Vector3d right = up.cross(backward).normalized();
  camera.rotation_.row(0) = right;
  camera.rotation_.row(1) = backward.cross(right);
  camera.rotation_.row(2) = backward;

  const double shorter = std::min(width, height);
  camera.focal_ = 0.5 * shorter / std::tan(0.5 * kFieldOfView);
  camera.middle_ = 0.5 * Eigen::Vector2d(width, height);
  const double slope_x = (0.5 - kMargin) * width / camera.focal_;
  const double slope_y = (0.5 - kMargin) * height / camera.focal_;
  // Each point asks for |x - eye_x| <= slope_x * (eye_z - z). The tightest pair of opposite points
  // fixes the eye sideways and its distance, exactly and for each direction on its own.
  double right_most = -1e300, left_most = -1e300, top_most = -1e300, bottom_most = -1e300;
  double nearest = -1e300;
  for (const Eigen::Vector3d& p : positions) {
    const Eigen::Vector3d v = camera.ToView(p);
    right_most = std::max(right_most, v.x() + slope_x * v.z());
    left_most = std::max(left_most, -v.x() + slope_x * v.z());
    top_most = std::max(top_most, v.y() + slope_y * v.z());
    bottom_most = std::max(bottom_most, -v.y() + slope_y * v.z());
    nearest = std::max(nearest, v.z());
  }
  const double distance_x = 0.5 * (right_most + left_most) / slope_x;
  const double distance_y = 0.5 * (top_most + bottom_most) / slope_y;
  camera.eye_ = {0.5 * (right_most - left_most), 0.5 * (top_most - bottom_most),
                 std::max({distance_x, distance_y, nearest + 0.5})};
  return camera;
}

}  // namespace ccst
