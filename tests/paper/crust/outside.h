#pragma once

#include <vector>

#include <Eigen/Core>

namespace ccst {

/// Leaves out triangles at sharp edges until there are none: edges whose triangles all lie within
/// a wedge of less than a right angle. Edges of a single triangle are such when `trim_holes`.
/// Cost O(m) hash look-ups.
void TrimSharpEdges(const std::vector<Eigen::Vector3d>& points, bool trim_holes,
                    std::vector<Eigen::Vector3i>* triangles);

/// Of each piece connected through edges the triangles that are seen from outside, oriented that
/// way: from one on the outside over each edge to the next around it. Holes end the walk.
std::vector<Eigen::Vector3i> WalkOutside(const std::vector<Eigen::Vector3d>& points,
                                         const std::vector<Eigen::Vector3i>& triangles);

}  // namespace ccst
