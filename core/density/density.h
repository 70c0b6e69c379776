#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/image.h"
#include "core/surface/surface.h"

namespace ccst {

/// The target density rho > 0 of samples on a surface: uniform, linear over each face, or an image
/// over texture coordinates. Scaled so that its mean over the surface is 1; only ratios count.
/// Immutable; holds no reference to the surface.
class Density {
 public:
  /// rho = 1.
  static Density Uniform(const Surface& surface);

  /// Linear over each face.
  /// @param corners       3 F values, finite and >= 0, not all zero.
  /// @param max_contrast  values below the largest over this are raised to it; > 1.
  /// @param interrupt     may be null.
  /// @errors INVALID_ARGUMENT DENSITY_INVALID naming the first wrong value, OPTION_INVALID; those
  ///         of Interrupt::Error().
  static absl::StatusOr<Density> Linear(const Surface& surface, std::vector<double> corners,
                                        double max_contrast, Interrupt* interrupt = nullptr);

  /// The values of `image`, bilinear between pixel centres, over texture coordinates, which are
  /// repeated outside [0, 1].
  /// @param coordinates  3 F texture coordinates, linear over each face; (0, 0) is the lower left.
  /// @param image        kept, with a third more for the images of halved sizes.
  /// @errors as Linear().
  static absl::StatusOr<Density> Textured(const Surface& surface,
                                          const std::vector<Eigen::Vector2d>& coordinates,
                                          Image image, double max_contrast,
                                          Interrupt* interrupt = nullptr);

  bool uniform() const { return corners_.empty() && pyramid_.empty(); }

  /// rho at a point of a face, averaged over a footprint of about `area` [unit^2] around it where
  /// the density comes from an image; exact where it is linear.
  double At(std::int32_t face, const Eigen::Vector3d& weights, double area = 0.0) const;

  /// Integral of rho over the face, the capacity of the face [unit^2]. F.
  const std::vector<double>& face_capacities() const { return face_capacities_; }
  /// Integral of rho over each component of the surface.
  const std::vector<double>& component_capacities() const { return component_capacities_; }

  /// Weights of the point at `t` in [0, 1) of a space-filling order of `face` that preserves
  /// capacity: equal intervals of t cover equal capacities.
  Eigen::Vector3d PointAt(std::int32_t face, double t) const;

 private:
  Density() = default;
  double Value(std::int32_t face, const Eigen::Vector3d& weights, double area) const;
  /// Integrals over the faces and their parts.
  /// @param part  corners (barycentric) of part `index` of `level`. @return the mean over it.
  double BuildTree(std::int32_t face, const std::array<Eigen::Vector3d, 3>& part, int level,
                   std::size_t index);
  void PlanTrees(const Surface& surface);
  absl::Status Normalise(const Surface& surface, Interrupt* interrupt);

  double scale_ = 1.0;
  double floor_ = 0.0;
  std::vector<double> corners_;               // 3 F, or empty.
  std::vector<Eigen::Vector2f> coordinates_;  // 3 F, or empty.
  std::vector<float> pixels_per_area_;        // F: pixels under one unit of area.
  std::vector<Image> pyramid_;                // Of halved sizes, or empty.
  std::vector<std::int8_t> depths_;           // F: how often a face is quartered.
  std::vector<std::size_t> tree_starts_;      // F: into means_.
  std::vector<float> means_;                  // Over the parts of faces, level by level.
  std::vector<double> face_areas_;            // F.
  std::vector<double> face_capacities_;
  std::vector<double> component_capacities_;
};

}  // namespace ccst
