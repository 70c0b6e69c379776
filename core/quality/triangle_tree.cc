#include "core/quality/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ccst::quality {
namespace {

constexpr std::int32_t kLeafSize = 4;
// Triangles put in order that are one unit of work of an Interrupt.
constexpr std::int32_t kTrianglesAUnit = 64;

Eigen::Vector3d ClosestPointOnSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                      const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double length = ab.squaredNorm();
  if (!(length > 0.0)) return a;
  return a + std::clamp((p - a).dot(ab) / length, 0.0, 1.0) * ab;
}

}  // namespace

Eigen::Vector3d ClosestPointOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  if (squared > 0.0) {
    // Inside the prism over the triangle the foot of the perpendicular is closest.
    const double wa = (c - b).cross(p - b).dot(normal);
    const double wb = (a - c).cross(p - c).dot(normal);
    const double wc = (b - a).cross(p - a).dot(normal);
    if (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) {
      return p - ((p - a).dot(normal) / squared) * normal;
    }
  }
  const Eigen::Vector3d candidates[] = {ClosestPointOnSegment(p, a, b),
                                        ClosestPointOnSegment(p, b, c),
                                        ClosestPointOnSegment(p, c, a)};
  return *std::min_element(std::begin(candidates), std::end(candidates),
                           [&p](const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
                             return (x - p).squaredNorm() < (y - p).squaredNorm();
                           });
}

TriangleTree::TriangleTree(std::span<const Eigen::Vector3d> positions,
                           std::span<const Eigen::Vector3i> triangles, Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  triangles_.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Eigen::Vector3i& t = triangles[i];
    triangles_.push_back(
        {positions[t[0]], positions[t[1]], positions[t[2]], static_cast<std::int64_t>(i)});
  }
  if (triangles_.empty()) return;
  nodes_.reserve(triangles_.size());
  BuildNode(0, static_cast<std::int32_t>(triangles_.size()), interrupt);
}

std::int32_t TriangleTree::BuildNode(std::int32_t begin, std::int32_t end, Interrupt* interrupt) {
  const auto id = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  Eigen::AlignedBox3d centres;
  for (std::int32_t i = begin; i < end; ++i) {
    const Triangle& t = triangles_[i];
    box.extend(t.a).extend(t.b).extend(t.c);
    centres.extend(t.a + t.b + t.c);
  }
  nodes_[id].box = box;
  if (end - begin <= kLeafSize || interrupt->RequestedAfter(1 + (end - begin) / kTrianglesAUnit)) {
    nodes_[id].begin = begin;
    nodes_[id].end = end;
    return id;
  }
  // Halving by count bounds the depth by log2 m, whatever the triangles look like.
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::int32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle,
                   triangles_.begin() + end, [axis](const Triangle& s, const Triangle& t) {
                     return s.a[axis] + s.b[axis] + s.c[axis] < t.a[axis] + t.b[axis] + t.c[axis];
                   });
  BuildNode(begin, middle, interrupt);
  const std::int32_t right = BuildNode(middle, end, interrupt);
  nodes_[id].right = right;
  return id;
}

TriangleTree::Hit TriangleTree::FindClosest(const Eigen::Vector3d& p, double bound) const {
  Hit hit;
  if (nodes_.empty()) return hit;
  double best = bound * bound;
  // Depth is at most log2(2^31), and each level leaves one node behind.
  std::pair<std::int32_t, double> stack[64];
  int size = 0;
  stack[size++] = {0, nodes_[0].box.squaredExteriorDistance(p)};
  while (size > 0) {
    const auto [id, squared] = stack[--size];
    if (!(squared < best)) continue;
    const Node& node = nodes_[id];
    if (node.end == 0) {
      std::pair<std::int32_t, double> near = {id + 1,
                                              nodes_[id + 1].box.squaredExteriorDistance(p)};
      std::pair<std::int32_t, double> far = {node.right,
                                             nodes_[node.right].box.squaredExteriorDistance(p)};
      if (far.second < near.second) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
      continue;
    }
    for (std::int32_t i = node.begin; i < node.end; ++i) {
      const Triangle& t = triangles_[i];
      const Eigen::Vector3d point = ClosestPointOnTriangle(p, t.a, t.b, t.c);
      const double distance = (point - p).squaredNorm();
      if (!(distance < best)) continue;
      best = distance;
      hit.triangle = t.index;
      hit.point = point;
    }
  }
  if (hit.triangle >= 0) hit.distance = std::sqrt(best);
  return hit;
}

}  // namespace ccst::quality
