#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/density/density.h"
#include "core/surface/surface.h"

namespace ccst::analysis {

/// The surface in small triangles of about equal capacity: every face is divided into k^2 equal
/// ones, k >= 1. Parts are numbered face by face.
class FaceParts {
 public:
  /// @param count  parts wanted, > 0; there are at least as many, and at least one a face.
  /// Cost O(F + parts).
  FaceParts(const Surface& surface, const Density& density, double count);

  std::int64_t size() const { return first_.back(); }
  /// The first part of a face; of face F, size().
  std::int64_t first(std::int32_t face) const { return first_[static_cast<std::size_t>(face)]; }
  /// Integral of the density over a part [unit^2].
  double Capacity(std::int64_t part) const { return capacity_[static_cast<std::size_t>(part)]; }
  /// Weights on `face` of the centroid of `part`, which is one of its parts.
  Eigen::Vector3d Centroid(std::int32_t face, std::int64_t part) const;
  /// The part in which a point lies; on a side between two, one of them.
  std::int64_t Find(const SurfacePoint& point) const;

 private:
  std::vector<std::int64_t> first_;  // F + 1.
  std::vector<std::int32_t> rows_;   // F: k.
  std::vector<double> capacity_;
};

}  // namespace ccst::analysis
