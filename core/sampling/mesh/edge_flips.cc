#include "core/sampling/mesh/edge_flips.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace ccst::internal {
namespace {

/// Triangles that face the surface less than this may not come out of a flip unless they do so
/// already.
constexpr double kLeastFacing = 0.3;
/// Relative, so that co-circular points do not flip for ever.
constexpr double kMargin = 1e-9;

}  // namespace

double Facing(const std::vector<Eigen::Vector3d>& position,
              const std::vector<Eigen::Vector3d>& normal, std::int32_t a, std::int32_t b,
              std::int32_t c) {
  const Eigen::Vector3d cross = (position[b] - position[a]).cross(position[c] - position[a]);
  const Eigen::Vector3d sum = normal[a] + normal[b] + normal[c];
  const double scale = std::sqrt(cross.squaredNorm() * sum.squaredNorm());
  return scale > 0.0 ? cross.dot(sum) / scale : 0.0;
}

bool FlipImproves(const std::vector<Eigen::Vector3d>& position,
                  const std::vector<Eigen::Vector3d>& normal, std::int32_t a, std::int32_t b,
                  std::int32_t c, std::int32_t d) {
  const Eigen::Vector3d ca = position[a] - position[c];
  const Eigen::Vector3d cb = position[b] - position[c];
  const Eigen::Vector3d da = position[a] - position[d];
  const Eigen::Vector3d db = position[b] - position[d];
  const double cos_c = ca.dot(cb);
  const double cos_d = da.dot(db);
  if (cos_c >= 0.0 && cos_d >= 0.0) return false;
  if (cos_c >= 0.0 || cos_d >= 0.0) {
    // Whether the obtuse angle exceeds a right one by more than the other one falls short of it.
    const double at_c = cos_c * cos_c * da.cross(db).squaredNorm();
    const double at_d = cos_d * cos_d * ca.cross(cb).squaredNorm();
    const bool is_wide =
        cos_c < 0.0 ? at_d < at_c * (1.0 - kMargin) : at_c < at_d * (1.0 - kMargin);
    if (!is_wide) return false;
  }
  const double after =
      std::min(Facing(position, normal, d, c, a), Facing(position, normal, c, d, b));
  return after >= kLeastFacing ||
         after > std::min(Facing(position, normal, a, b, c), Facing(position, normal, b, a, d));
}

bool EdgeFlips::IsWanted(std::int32_t h) const {
  const std::int32_t g = mesh_.twin[h];
  return g >= 0 &&
         FlipImproves(position_, normal_, mesh_.origin[h], mesh_.origin[g], mesh_.Apex(h),
                      mesh_.Apex(g)) &&
         mesh_.CanFlip(h);
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

/// The area falls with every flip, so there are no more than these unless rounding makes edges of
/// thin triangles flip to and fro.
std::int64_t EdgeFlips::MostFlips() const {
  return 64 + 16 * static_cast<std::int64_t>(mesh_.origin.size());
}

std::int64_t EdgeFlips::Drain(std::int64_t most, Interrupt* interrupt) {
  std::int64_t flips = 0;
  while (!stack_.empty()) {
    if (interrupt != nullptr && interrupt->RequestedAfter(1)) {
      stack_.clear();
      break;
    }
    const std::int32_t h = stack_.back();
    stack_.pop_back();
    if (mesh_.origin[h] < 0 || flips >= most) continue;
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
      if (known_ != nullptr) known_[mesh_.origin[e]] = 0;
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
    flips += Drain(MostFlips() - flips, interrupt);
  }
  return flips;
}

std::int64_t EdgeFlips::FlipAround(std::int32_t v, Interrupt* interrupt) {
  mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
    Push(h);
    Push(SampleMesh::Next(h));
  });
  return Drain(MostFlips(), interrupt);
}

std::int64_t EdgeFlips::FlipThese(const std::vector<std::int32_t>& half_edges,
                                  Interrupt* interrupt) {
  std::int64_t flips = 0;
  for (const std::int32_t h : half_edges) {
    Push(h);
    flips += Drain(MostFlips() - flips, interrupt);
  }
  return flips;
}

}  // namespace ccst::internal
