#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>

namespace ccst::quality {

/// Angles of the triangles of a sample mesh.
struct AngleFigures {
  static constexpr int kBins = 90;
  static constexpr double kBinWidth = 180.0 / kBins;  ///< [degree]
  double smallest = 0.0;                              ///< [degree], in [0, 60].
  double mean_smallest = 0.0;   ///< Mean over the triangles of their smallest angle [degree].
  double share_below_30 = 0.0;  ///< Of all angles, in [0, 1].
  double share_above_90 = 0.0;  ///< Of all angles, in [0, 1].
  /// Angles by size, bin k from k to k + 1 widths; the last holds 180 degrees too.
  std::array<std::int64_t, kBins> histogram{};
};

/// Measures all 3 m angles. A triangle of zero area has the angles 0, 0, 180.
/// @param positions  n x 3 [mesh unit].
/// @param triangles  m x 3 indices in [0, n). All figures are 0 for m = 0.
AngleFigures MeasureAngles(std::span<const Eigen::Vector3d> positions,
                           std::span<const Eigen::Vector3i> triangles);

/// How near triangles are to equilateral: Q = 2 sqrt(3) r / h, r the radius of the inscribed
/// circle, h the longest side; 1 for an equilateral triangle, 0 for one without area. Source: Frey,
/// Borouchaki, "Surface mesh evaluation", IMR 1997, as used by Xu et al. 2012.
struct ShapeFigures {
  double smallest = 0.0;  ///< Q_min, in [0, 1].
  double mean = 0.0;      ///< Q_avg, in [0, 1].
};

/// Measures all m triangles. Arguments as for MeasureAngles().
ShapeFigures MeasureShapes(std::span<const Eigen::Vector3d> positions,
                           std::span<const Eigen::Vector3i> triangles);

/// Number of edges at the vertices off the boundary.
struct ValenceFigures {
  static constexpr int kBins = 16;
  std::array<std::int64_t, kBins> histogram{};  ///< By valence; the last bin holds the rest.
  std::int64_t inner_vertices = 0;              ///< Vertices counted.
  double share_5_to_7 = 1.0;                    ///< Of them, in [0, 1]; 1 if there are none.
};

/// Counts valences. A vertex is off the boundary when every edge at it has two faces.
/// @param triangles  m x 3 indices in [0, vertex_count).
ValenceFigures MeasureValences(std::int64_t vertex_count,
                               std::span<const Eigen::Vector3i> triangles);

/// Number of triangles whose normal points against the sum of the surface normals at their
/// three samples, or is orthogonal to it; triangles without a normal count as well.
/// @param normals  n x 3, of the surface at the samples.
std::int64_t CountTurnedOver(std::span<const Eigen::Vector3d> positions,
                             std::span<const Eigen::Vector3d> normals,
                             std::span<const Eigen::Vector3i> triangles);

}  // namespace ccst::quality
