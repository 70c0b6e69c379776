#pragma once

#include <span>

#include <Eigen/Core>

namespace ccst {

/// A pinhole camera over a square-pixel picture. View space: x right, y up, z towards the viewer,
/// lengths in units of the object's largest extent, origin in the middle of its bounding box.
class Camera {
 public:
  /// A three-quarter view that shows every point of `positions` (V x 3, finite) within a
  /// width x height picture and leaves a small margin. y is up, unless the bounding box is so flat
  /// that its thin axis must be the upright one. Cost O(V).
  static Camera Framing(std::span<const Eigen::Vector3d> positions, int width, int height);

  /// From mesh units to view space.
  Eigen::Vector3d ToView(const Eigen::Vector3d& position) const {
    return rotation_ * ((position - center_) * inverse_extent_);
  }
  /// A direction of mesh space in view space; lengths are kept.
  Eigen::Vector3d RotateToView(const Eigen::Vector3d& direction) const {
    return rotation_ * direction;
  }
  /// Distance from the camera along the view axis; positive for every framed point.
  double Depth(const Eigen::Vector3d& view) const { return eye_.z() - view.z(); }
  /// Pixel coordinates (x right, y down) of a point in view space.
  Eigen::Vector2d ToPixel(const Eigen::Vector3d& view) const {
    const double scale = focal_ / Depth(view);
    return {middle_.x() + scale * (view.x() - eye_.x()),
            middle_.y() - scale * (view.y() - eye_.y())};
  }
  /// The point in view space seen at `pixel` in the given depth.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& pixel, double depth) const {
    const double scale = depth / focal_;
    return {eye_.x() + scale * (pixel.x() - middle_.x()),
            eye_.y() - scale * (pixel.y() - middle_.y()), eye_.z() - depth};
  }
  /// Pixels that a length of 1 in view space covers at the given depth.
  double PixelsPerUnit(double depth) const { return focal_ / depth; }
  /// View units in one mesh unit.
  double inverse_extent() const { return inverse_extent_; }
  /// Where the camera stands, in view space.
  const Eigen::Vector3d& eye() const { return eye_; }

 private:
  Eigen::Matrix3d rotation_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double inverse_extent_ = 1.0;
  Eigen::Vector3d eye_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double focal_ = 1.0;  ///< [pixel]
};

}  // namespace ccst
