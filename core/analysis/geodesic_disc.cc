#include "core/analysis/geodesic_disc.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/surface/frame.h"

namespace ccst::analysis {
namespace {

// Square of the distance of the origin to a side.
double SquaredDistance(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0.0 ? std::clamp(-a.dot(along) / length, 0.0, 1.0) : 0.0;
  return (a + t * along).squaredNorm();
}

// A face laid nearer than this share of the straight distance in space was unfolded along a path
// that is far from straight: no way along the surface is shorter than the chord.
constexpr double kShortest = 0.99;

// Length of the shortest way from the origin to `to` through the side from `a` to `b`.
double LengthThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                     const Eigen::Vector2d& to) {
  const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
    return u.x() * v.y() - u.y() * v.x();
  };
  const double left = cross(a, to);
  const double right = cross(to, b);
  if (left >= 0.0 && right >= 0.0) return to.norm();
  const Eigen::Vector2d& corner = left < right ? a : b;
  return corner.norm() + (to - corner).norm();
}

}  // namespace

GeodesicDisc::GeodesicDisc(const Surface& surface)
    : surface_(surface), visited_(static_cast<std::size_t>(surface.face_count()), 0) {}

// The face beyond the side `half_edge` of a face that was laid flat, whose ends lie at `from` and
// `to`.
void GeodesicDisc::Offer(std::int32_t half_edge, const Eigen::Vector2d& from,
                         const Eigen::Vector2d& to, double radius) {
  const std::int32_t twin = surface_.twins()[static_cast<std::size_t>(half_edge)];
  if (twin < 0 || visited_[static_cast<std::size_t>(twin / 3)] == disc_) return;
  if (SquaredDistance(from, to) > radius * radius) return;
  const Eigen::Vector3i& face = surface_.faces()[static_cast<std::size_t>(twin / 3)];
  const int k = twin % 3;
  const Eigen::Vector3d& a = surface_.positions()[face[k]];
  const Eigen::Vector3d edge = surface_.positions()[face[(k + 1) % 3]] - a;
  const Eigen::Vector3d side = surface_.positions()[face[(k + 2) % 3]] - a;
  const double length = edge.squaredNorm();
  if (!(length > 0.0)) return;
  const double along = edge.dot(side) / length;
  const double across = edge.cross(side).norm() / length;
  const Eigen::Vector2d flat = from - to;  // The twin runs the other way.
  const Eigen::Vector2d apex = to + along * flat + across * Eigen::Vector2d(-flat.y(), flat.x());
  const Eigen::Vector2d centroid = (from + to + apex) / 3.0;
  const Eigen::Vector3d place = a + (edge + side) / 3.0;
  if (centroid.norm() < kShortest * (place - center_).norm()) return;
  queue_.push_back({LengthThrough(from, to, centroid), twin, {to, from, apex}});
  std::push_heap(queue_.begin(), queue_.end());
}

const std::vector<FlatFace>& GeodesicDisc::Unfold(const SurfacePoint& center, double radius,
                                                  Interrupt* interrupt) {
  ++disc_;
  center_ = center.position;
  faces_.clear();
  queue_.clear();
  const Eigen::Vector3i& host = surface_.faces()[static_cast<std::size_t>(center.face)];
  const Eigen::Vector3d& p = surface_.positions()[host[0]];
  const Eigen::Vector3d& q = surface_.positions()[host[1]];
  const Eigen::Vector3d& r = surface_.positions()[host[2]];
  const Eigen::Vector3d normal = (q - p).cross(r - p).normalized();
  Eigen::Vector3d t1;
  Eigen::Vector3d t2;
  TangentFrame(normal, &t1, &t2);
  const auto lay = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d offset = point - center.position;
    return Eigen::Vector2d(offset.dot(t1), offset.dot(t2));
  };
  visited_[static_cast<std::size_t>(center.face)] = disc_;
  faces_.push_back({center.face, {lay(p), lay(q), lay(r)}});
  const std::array<Eigen::Vector2d, 3> first = faces_.front().corners;
  for (int k = 0; k < 3; ++k) {
    Offer(3 * center.face + k, first[k], first[(k + 1) % 3], radius);
  }
  while (!queue_.empty()) {
    if (interrupt != nullptr && interrupt->RequestedAfter(1)) break;
    std::pop_heap(queue_.begin(), queue_.end());
    const Candidate next = queue_.back();
    queue_.pop_back();
    const std::int32_t face = next.half_edge / 3;
    const int k = next.half_edge % 3;
    if (visited_[static_cast<std::size_t>(face)] == disc_) continue;
    visited_[static_cast<std::size_t>(face)] = disc_;
    FlatFace flat;
    flat.face = face;
    for (int i = 0; i < 3; ++i) flat.corners[(k + i) % 3] = next.corners[i];
    faces_.push_back(flat);
    Offer(3 * face + (k + 1) % 3, next.corners[1], next.corners[2], radius);
    Offer(3 * face + (k + 2) % 3, next.corners[2], next.corners[0], radius);
  }
  return faces_;
}

}  // namespace ccst::analysis
