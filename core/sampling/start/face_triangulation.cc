#include "core/sampling/start/face_triangulation.h"

#include <cmath>

#include <Eigen/Geometry>

namespace ccst::internal {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a[0] * b[1] - a[1] * b[0];
}

}  // namespace

void FaceTriangulation::Start(const std::vector<Eigen::Vector3d>& place) {
  // As SetTriangles() does, which is meant for many.
  mesh_.origin.assign({0, 1, 2});
  mesh_.twin.assign({-1, -1, -1});
  mesh_.outgoing.assign({0, 1, 2});
  SetPlane(place, {0, 1, 2});
}

void FaceTriangulation::Start(const std::vector<Eigen::Vector3d>& place,
                              const std::vector<Eigen::Vector3i>& triangles) {
  mesh_.SetTriangles(static_cast<std::int32_t>(place.size()), triangles);
  // The triangle with the largest area tells the plane best.
  Eigen::Vector3i largest = triangles[0];
  double most = -1.0;
  for (const Eigen::Vector3i& t : triangles) {
    const double area = (place[t[1]] - place[t[0]]).cross(place[t[2]] - place[t[0]]).norm();
    if (area <= most) continue;
    most = area;
    largest = t;
  }
  SetPlane(place, largest);
}

void FaceTriangulation::SetPlane(const std::vector<Eigen::Vector3d>& place,
                                 const Eigen::Vector3i& corner) {
  corner_ = place[corner[0]];
  const Eigen::Vector3d side = place[corner[1]] - corner_;
  const Eigen::Vector3d up = side.cross(place[corner[2]] - corner_);
  // Zero for a face without area: all of its points are at one place, and none is flipped.
  along_ = side.stableNormalized();
  aside_ = up.stableNormalized().cross(along_);
  outer_ = static_cast<std::int32_t>(place.size());
  last_ = TriangleIndex(0);
  place_.clear();
  for (const Eigen::Vector3d& p : place) place_.push_back(Flat(p));
}

Eigen::Vector2d FaceTriangulation::Flat(const Eigen::Vector3d& point) const {
  return {(point - corner_).dot(along_), (point - corner_).dot(aside_)};
}

TriangleIndex FaceTriangulation::Locate(const Eigen::Vector2d& p) {
  TriangleIndex t = last_;
  // A walk; rounding may lead it in circles.
  for (int step = 0; step < 10000; ++step) {
    double worst = 0.0;
    TriangleIndex cross;
    for (std::int32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const Eigen::Vector2d& a = place_[mesh_.origin[h]];
      const double side = Cross(place_[mesh_.Target(h)] - a, p - a);
      if (side < worst && mesh_.twin[h] >= 0) {
        worst = side;
        cross = SampleMesh::TriangleOf(mesh_.twin[h]);
      }
    }
    if (cross < 0) break;
    t = cross;
    ++work_;
  }
  return t;
}

void FaceTriangulation::Insert(const Eigen::Vector3d& point) {
  const auto vertex = static_cast<std::int32_t>(place_.size());
  place_.push_back(Flat(point));
  mesh_.outgoing.push_back(-1);
  work_ = 0;
  const TriangleIndex t = Locate(place_.back());
  const TriangleIndex slot1 = mesh_.NewTriangle();
  const TriangleIndex slot2 = mesh_.NewTriangle();
  mesh_.InsertIntoTriangle(vertex, t, slot1, slot2);
  last_ = t;
  stack_.assign({3 * t, 3 * slot1, 3 * slot2});
  while (!stack_.empty()) {
    const std::int32_t h = stack_.back();
    stack_.pop_back();
    const std::int32_t g = mesh_.twin[h];
    if (g < 0 || !IsWanted(h) || !mesh_.CanFlip(h)) continue;
    mesh_.Flip(h);
    ++work_;
    // The two edges away from the new vertex may now violate the criterion.
    for (const std::int32_t e : {h, g}) {
      for (const std::int32_t side : {SampleMesh::Next(e), SampleMesh::Previous(e)}) {
        if (mesh_.Apex(side) == vertex) stack_.push_back(side);
      }
    }
  }
}

/// True when the edge `h` is not Delaunay and the flip is a proper one.
bool FaceTriangulation::IsWanted(std::int32_t h) const {
  const std::int32_t g = mesh_.twin[h];
  const std::int32_t apex_c = mesh_.Apex(h);
  const std::int32_t apex_d = mesh_.Apex(g);
  // Another face may join them already.
  if (apex_c < outer_ && apex_d < outer_) return false;
  const Eigen::Vector2d& c = place_[apex_c];
  const Eigen::Vector2d& d = place_[apex_d];
  const Eigen::Vector2d ca = place_[mesh_.origin[h]] - c;
  const Eigen::Vector2d cb = place_[mesh_.origin[g]] - c;
  const Eigen::Vector2d da = place_[mesh_.origin[h]] - d;
  const Eigen::Vector2d db = place_[mesh_.origin[g]] - d;
  const double cos_c = ca.dot(cb);
  const double cos_d = da.dot(db);
  if (cos_c >= 0.0 && cos_d >= 0.0) return false;
  const double sin_c = Cross(ca, cb);
  const double sin_d = Cross(db, da);
  const double margin = 1e-10 * (std::abs(cos_c) + sin_c) * (std::abs(cos_d) + sin_d);
  if (!(sin_c * cos_d + cos_c * sin_d < -margin)) return false;
  return Cross(c - d, da) > 0.0 && Cross(d - c, cb) > 0.0;
}

}  // namespace ccst::internal
