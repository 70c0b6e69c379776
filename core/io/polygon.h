#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace ccst::io {

/// How PolygonCutter::Cut() ended.
enum class PolygonCut {
  kWhole,         ///< The triangles cover the polygon and nothing else.
  kSelfCrossing,  ///< The boundary crosses itself; the triangles are the best that could be found.
  kTooComplex,    ///< More work than is allowed for one polygon; there are no triangles.
};

/// Cuts polygons without holes into triangles. Keeps its memory from one polygon to the next.
class PolygonCutter {
 public:
  /// Cuts a polygon of k >= 3 corners into k - 2 triangles, whose corners are indices into
  /// `corners` in the polygon's own sense of rotation.
  ///
  /// The polygon is seen along the normal of its best plane (Newell). A convex one starts as a fan
  /// around its first corner, any other one by clipping the ear with the largest smallest angle
  /// first; then diagonals are flipped while that makes the smallest angle of the two triangles
  /// beside them larger, in space, so that the triangulation of a flat polygon is Delaunay and a
  /// bent quadrilateral gets the better diagonal. Among equals nothing is flipped: a rectangle
  /// stays the fan around its first corner. The result depends on the corners' coordinates alone.
  ///
  /// Cost O(k log k) for polygons that people have; for others it ends with kTooComplex after
  /// kMaxTests tests of a corner against an ear, about a second.
  PolygonCut Cut(std::span<const Eigen::Vector3d> corners,
                 std::vector<std::array<std::int32_t, 3>>& triangles);

  static constexpr std::int64_t kMaxTests = 50'000'000;

 private:
  using Triangle = std::array<std::int32_t, 3>;

  double Turn(std::int32_t a, std::int32_t b, std::int32_t c) const;
  double LargestCosine(const Triangle& triangle) const;
  bool SetPlane();
  bool IsConvex() const;
  bool TurnsOnce() const;
  bool ClipEars(std::vector<Triangle>& triangles);
  void BuildGrid();
  std::array<std::int32_t, 4> CellsOf(const Triangle& ear) const;
  bool IsFree(const Triangle& ear);
  double Rate(std::int32_t corner);
  void FlipDiagonals(std::vector<Triangle>& triangles);

  std::span<const Eigen::Vector3d> corners_;
  std::vector<Eigen::Vector2d> flat_;  // Seen along the dominant axis of the normal.
  std::vector<std::int32_t> next_, previous_;
  std::vector<char> is_reflex_;  // Reflex or straight, and still part of what is left.
  std::vector<std::int32_t> cell_start_, cell_items_;
  Eigen::Vector2d grid_low_, grid_scale_;
  std::int32_t grid_size_ = 1;  // Cells along each side.
  std::int64_t tests_left_ = 0;
  bool is_forced_ = false;
};

}  // namespace ccst::io
