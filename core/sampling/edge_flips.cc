#include "core/sampling/edge_flips.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace ccst {
namespace {

/// Triangles that face the surface less than this may not come out of a flip unless they do so
/// already.
constexpr double kLeastFacing = 0.3;

}  // namespace

double Facing(const std::vector<Eigen::Vector3d>& position,
              const std::vector<Eigen::Vector3d>& normal, std::int32_t a, std::int32_t b,
              std::int32_t c) {
  const Eigen::Vector3d cross = (position[b] - position[a]).cross(position[c] - position[a]);
  const Eigen::Vector3d sum = normal[a] + normal[b] + normal[c];
  const double scale = std::sqrt(cross.squaredNorm() * sum.squaredNorm());
  return scale > 0.0 ? cross.dot(sum) / scale : 0.0;
}

bool EdgeFlips::IsWanted(std::int32_t h) const {
  const std::int32_t g = mesh_.twin[h];
  if (g < 0) return false;
  const std::int32_t a = mesh_.origin[h];
  const std::int32_t b = mesh_.origin[g];
  const std::int32_t c = mesh_.Apex(h);
  const std::int32_t d = mesh_.Apex(g);
  const Eigen::Vector3d ca = position_[a] - position_[c];
  const Eigen::Vector3d cb = position_[b] - position_[c];
  const Eigen::Vector3d da = position_[a] - position_[d];
  const Eigen::Vector3d db = position_[b] - position_[d];
  const double cos_c = ca.dot(cb);
  const double cos_d = da.dot(db);
  if (cos_c >= 0.0 && cos_d >= 0.0) return false;
  const double sin_c = ca.cross(cb).norm();
  const double sin_d = da.cross(db).norm();
  // sin(c + d) < 0, with a margin so that co-circular points do not flip for ever.
  const double scale = std::sqrt((cos_c * cos_c + sin_c * sin_c) * (cos_d * cos_d + sin_d * sin_d));
  if (!(sin_c * cos_d + cos_c * sin_d < -1e-10 * scale)) return false;
  const double after =
      std::min(Facing(position_, normal_, d, c, a), Facing(position_, normal_, c, d, b));
  if (after < kLeastFacing) {
    const double before =
        std::min(Facing(position_, normal_, a, b, c), Facing(position_, normal_, b, a, d));
    if (after <= before) return false;
  }
  return mesh_.CanFlip(h);
}

void EdgeFlips::Restrict(std::int32_t first, std::int32_t end) {
  first_ = first;
  end_ = end;
}

bool EdgeFlips::IsWithin(std::int32_t h) const {
  const std::int32_t g = mesh_.twin[h];
  const auto is_within = [&](std::int32_t v) { return v >= first_ && v < end_; };
  return is_within(mesh_.origin[h]) && is_within(mesh_.Target(h)) && is_within(mesh_.Apex(h)) &&
         (g < 0 || is_within(mesh_.Apex(g)));
}

void EdgeFlips::Push(std::int32_t h) { stack_.push_back(h); }

std::int64_t EdgeFlips::Drain() {
  std::int64_t flips = 0;
  // The area falls with every flip; the cap only guards against rounding.
  const std::int64_t cap = 64 + 16 * static_cast<std::int64_t>(mesh_.origin.size());
  while (!stack_.empty()) {
    const std::int32_t h = stack_.back();
    stack_.pop_back();
    if (mesh_.origin[h] < 0 || flips >= cap) continue;
    if (!IsWithin(h)) {
      beyond.push_back(h);
      continue;
    }
    if (!IsWanted(h)) continue;
    const std::int32_t g = mesh_.twin[h];
    mesh_.Flip(h);
    ++flips;
    for (const std::int32_t e : {SampleMesh::Next(h), SampleMesh::Previous(h), SampleMesh::Next(g),
                                 SampleMesh::Previous(g)}) {
      touched.push_back(mesh_.origin[e]);
      Push(e);
    }
  }
  return flips;
}

std::int64_t EdgeFlips::FlipAll(Interrupt* interrupt) {
  std::int64_t flips = 0;
  for (std::int32_t h = 0; h < static_cast<std::int32_t>(mesh_.origin.size()); ++h) {
    if (interrupt != nullptr && interrupt->RequestedAt(h)) break;
    if (mesh_.origin[h] < 0 || mesh_.twin[h] < h) continue;
    Push(h);
    flips += Drain();
  }
  return flips;
}

std::int64_t EdgeFlips::FlipAround(std::int32_t v) {
  mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
    Push(h);
    Push(SampleMesh::Next(h));
  });
  return Drain();
}

std::int64_t EdgeFlips::FlipThese(const std::vector<std::int32_t>& half_edges) {
  std::int64_t flips = 0;
  for (const std::int32_t h : half_edges) {
    Push(h);
    flips += Drain();
  }
  return flips;
}

}  // namespace ccst
