#include "core/io/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include "core/base/portable_math.h"

namespace ccst::io {
namespace {

// Ears worth less than this are clipped only when there is no other.
constexpr double kNoEar = -2.0;
// Smallest gain in the cosine of the smallest angle for which a diagonal is flipped: rounding must
// not decide between equals.
constexpr double kLeastGain = 1e-9;

bool IsWithin(const Eigen::Vector2d& point, const Eigen::Vector2d& low,
              const Eigen::Vector2d& high) {
  return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
}

}  // namespace

// Twice the area of a triangle, positive where it turns left; 0 where rounding could decide.
double PolygonCutter::Turn(std::int32_t a, std::int32_t b, std::int32_t c) const {
  const Eigen::Vector2d ab = flat_[b] - flat_[a];
  const Eigen::Vector2d ac = flat_[c] - flat_[a];
  const double left = ab.x() * ac.y();
  const double right = ab.y() * ac.x();
  constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
  const double turn = left - right;
  return std::abs(turn) <= kRounding * (std::abs(left) + std::abs(right)) ? 0.0 : turn;
}

// Of the triangle's angles in space: 1 for a triangle without area, 0.5 for an equilateral one.
double PolygonCutter::LargestCosine(const Triangle& triangle) const {
  double largest = -1.0;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d& apex = corners_[triangle[k]];
    const Eigen::Vector3d a = corners_[triangle[(k + 1) % 3]] - apex;
    const Eigen::Vector3d b = corners_[triangle[(k + 2) % 3]] - apex;
    const double lengths = std::sqrt(a.squaredNorm() * b.squaredNorm());
    largest = std::max(largest, lengths > 0 ? a.dot(b) / lengths : 1.0);
  }
  return largest;
}

// Looks along the axis nearest to the polygon's normal, so that coordinates stay exact. False for
// a polygon without area.
bool PolygonCutter::SetPlane() {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d largest = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& origin = corners_[0];
  double scale = 0.0;
  for (std::size_t i = 2; i < corners_.size(); ++i) {
    const Eigen::Vector3d cross = (corners_[i - 1] - origin).cross(corners_[i] - origin);
    normal += cross;
    scale += cross.norm();
    if (cross.squaredNorm() > largest.squaredNorm()) largest = cross;
  }
  // The two halves of a bow tie cancel each other.
  if (!(normal.norm() > 1e-12 * scale)) normal = largest;
  if (!(normal.norm() > 0.0)) return false;
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  Eigen::Index u = (axis + 1) % 3;
  Eigen::Index v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  flat_.clear();
  for (const Eigen::Vector3d& corner : corners_) flat_.emplace_back(corner[u], corner[v]);
  return true;
}

bool PolygonCutter::IsConvex() const {
  const auto count = static_cast<std::int32_t>(flat_.size());
  for (std::int32_t i = 0; i < count; ++i) {
    if (!(Turn(i, (i + 1) % count, (i + 2) % count) > 0)) return false;
  }
  return TurnsOnce();
}

// Whether the edges' directions go around once, as those of every simple polygon do.
bool PolygonCutter::TurnsOnce() const {
  const std::size_t count = flat_.size();
  double turned = 0.0;
  Eigen::Vector2d before = Eigen::Vector2d::Zero();
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  const auto add = [&turned](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    turned += PortableAtan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d edge = flat_[(i + 1) % count] - flat_[i];
    if (edge.squaredNorm() == 0) continue;
    if (before.squaredNorm() > 0) add(before, edge);
    if (first.squaredNorm() == 0) first = edge;
    before = edge;
  }
  add(before, first);
  return std::abs(turned - 2 * M_PI) < 1.0;
}

// Sorts the corners that may lie within an ear into cells.
void PolygonCutter::BuildGrid() {
  std::vector<std::int32_t> reflex;
  for (std::size_t i = 0; i < flat_.size(); ++i) {
    if (is_reflex_[i] != 0) reflex.push_back(static_cast<std::int32_t>(i));
  }
  Eigen::Vector2d high = flat_[0];
  grid_low_ = flat_[0];
  for (const Eigen::Vector2d& point : flat_) {
    grid_low_ = grid_low_.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  grid_size_ = 1 + static_cast<std::int32_t>(std::sqrt(static_cast<double>(reflex.size()) / 2));
  for (int axis = 0; axis < 2; ++axis) {
    const double extent = high[axis] - grid_low_[axis];
    grid_scale_[axis] = extent > 0 ? grid_size_ / extent : 0.0;
  }
  cell_start_.assign(static_cast<std::size_t>(grid_size_) * grid_size_ + 1, 0);
  const auto cell = [this](std::int32_t i) {
    const auto cells = CellsOf({i, i, i});
    return cells[1] * grid_size_ + cells[0];
  };
  for (const std::int32_t i : reflex) ++cell_start_[cell(i) + 1];
  for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
  cell_items_.resize(reflex.size());
  std::vector<std::int32_t> at(cell_start_.begin(), cell_start_.end() - 1);
  for (const std::int32_t i : reflex) cell_items_[at[cell(i)]++] = i;
}

// First and last cell of the ear's bounding box: x, y, x, y.
std::array<std::int32_t, 4> PolygonCutter::CellsOf(const Triangle& ear) const {
  std::array<std::int32_t, 4> cells = {grid_size_, grid_size_, 0, 0};
  for (const std::int32_t i : ear) {
    for (int axis = 0; axis < 2; ++axis) {
      const double place = (flat_[i][axis] - grid_low_[axis]) * grid_scale_[axis];
      const auto c = static_cast<std::int32_t>(std::clamp(place, 0.0, grid_size_ - 1.0));
      cells[axis] = std::min(cells[axis], c);
      cells[axis + 2] = std::max(cells[axis + 2], c);
    }
  }
  return cells;
}

// Whether no other corner lies in or on the ear. Corners at the place of one of the ear's own do
// not count: bridges to holes pass through places twice.
bool PolygonCutter::IsFree(const Triangle& ear) {
  const auto [a, b, c] = ear;
  const Eigen::Vector2d low = flat_[a].cwiseMin(flat_[b]).cwiseMin(flat_[c]);
  const Eigen::Vector2d high = flat_[a].cwiseMax(flat_[b]).cwiseMax(flat_[c]);
  const auto cells = CellsOf(ear);
  for (std::int32_t y = cells[1]; y <= cells[3]; ++y) {
    const std::int32_t row = y * grid_size_;
    const std::int32_t end = cell_start_[row + cells[2] + 1];
    tests_left_ -= 1 + end - cell_start_[row + cells[0]];
    for (std::int32_t at = cell_start_[row + cells[0]]; at < end; ++at) {
      const std::int32_t i = cell_items_[at];
      if (is_reflex_[i] == 0 || i == a || i == b || i == c) continue;
      const Eigen::Vector2d& point = flat_[i];
      if (!IsWithin(point, low, high)) continue;
      if (point == flat_[a] || point == flat_[b] || point == flat_[c]) continue;
      if (Turn(a, b, i) >= 0 && Turn(b, c, i) >= 0 && Turn(c, a, i) >= 0) return false;
    }
  }
  return true;
}

// How good the ear at a corner is: the larger, the rounder; kNoEar where it may not be clipped.
double PolygonCutter::Rate(std::int32_t corner) {
  const Triangle ear = {previous_[corner], corner, next_[corner]};
  if (!(Turn(ear[0], ear[1], ear[2]) > 0) || !IsFree(ear)) return kNoEar;
  return -LargestCosine(ear);
}

// False when that took too much work.
bool PolygonCutter::ClipEars(std::vector<Triangle>& triangles) {
  const auto count = static_cast<std::int32_t>(flat_.size());
  next_.resize(flat_.size());
  previous_.resize(flat_.size());
  is_reflex_.assign(flat_.size(), 0);
  for (std::int32_t i = 0; i < count; ++i) {
    next_[i] = (i + 1) % count;
    previous_[i] = (i + count - 1) % count;
    is_reflex_[i] = Turn(previous_[i], i, next_[i]) > 0 ? 0 : 1;
  }
  BuildGrid();
  // Entries that a later rating of their corner has overtaken are passed over.
  using Entry = std::pair<double, std::int32_t>;
  const auto worse = [](const Entry& a, const Entry& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(worse)> ears(worse);
  std::vector<double> rating(flat_.size());
  const auto rate = [&](std::int32_t i) {
    rating[i] = Rate(i);
    if (rating[i] > kNoEar) ears.emplace(rating[i], i);
  };
  for (std::int32_t i = 0; i < count; ++i) rate(i);
  std::int32_t some = 0;  // A corner that is still there.
  for (std::int32_t left = count; left > 3; --left) {
    if (tests_left_ < 0) return false;
    while (!ears.empty() && rating[ears.top().second] != ears.top().first) ears.pop();
    std::int32_t ear = some;
    if (!ears.empty()) {
      ear = ears.top().second;
      ears.pop();
    } else {
      // Corners that lie on each other or on a line leave ears of no area, which add nothing. Any
      // other one means that the boundary crosses itself.
      std::int32_t straight = -1;
      std::int32_t i = some;
      for (std::int32_t k = 0; k < left && straight < 0; ++k, i = next_[i]) {
        if (Turn(previous_[i], i, next_[i]) == 0) straight = i;
      }
      tests_left_ -= left;
      is_forced_ = is_forced_ || straight < 0;
      ear = straight < 0 ? some : straight;
    }
    const std::int32_t before = previous_[ear];
    const std::int32_t after = next_[ear];
    triangles.push_back({before, ear, after});
    next_[before] = after;
    previous_[after] = before;
    is_reflex_[ear] = 0;
    rating[ear] = kNoEar;
    some = after;
    for (const std::int32_t i : {before, after}) {
      is_reflex_[i] = is_reflex_[i] != 0 && !(Turn(previous_[i], i, next_[i]) > 0) ? 1 : 0;
    }
    rate(before);
    rate(after);
  }
  triangles.push_back({previous_[some], some, next_[some]});
  is_forced_ = is_forced_ || Turn(previous_[some], some, next_[some]) < 0;
  return true;
}

// Lawson's algorithm, with angles in space.
void PolygonCutter::FlipDiagonals(std::vector<Triangle>& triangles) {
  // The triangle on the left of each directed edge.
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> left_of;
  const auto note = [&](std::int32_t t) {
    for (int k = 0; k < 3; ++k) left_of[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  };
  for (std::size_t t = 0; t < triangles.size(); ++t) note(static_cast<std::int32_t>(t));
  std::vector<std::pair<std::int32_t, std::int32_t>> queue;
  for (const auto& [edge, triangle] : left_of) {
    if (edge.first < edge.second && left_of.contains({edge.second, edge.first})) {
      queue.push_back(edge);
    }
  }
  const auto opposite = [&](std::int32_t t, std::int32_t a, std::int32_t b) {
    for (const std::int32_t c : triangles[t]) {
      if (c != a && c != b) return c;
    }
    return a;
  };
  // Each flip makes a smallest angle larger; in space, where that is not enough to end, a bound is.
  std::size_t flips_left = 20 * triangles.size();
  for (std::size_t at = 0; at < queue.size() && flips_left > 0; ++at) {
    const auto [a, b] = queue[at];
    const auto left = left_of.find({a, b});
    const auto right = left_of.find({b, a});
    if (left == left_of.end() || right == left_of.end()) continue;  // Flipped meanwhile.
    const std::int32_t s = left->second;
    const std::int32_t t = right->second;
    const std::int32_t c = opposite(s, a, b);
    const std::int32_t d = opposite(t, a, b);
    const Triangle first = {c, a, d};
    const Triangle second = {d, b, c};
    if (!(Turn(c, a, d) > 0 && Turn(d, b, c) > 0)) continue;
    const double now = std::max(LargestCosine(triangles[s]), LargestCosine(triangles[t]));
    const double then = std::max(LargestCosine(first), LargestCosine(second));
    if (!(then < now - kLeastGain)) continue;
    left_of.erase({a, b});
    left_of.erase({b, a});
    triangles[s] = first;
    triangles[t] = second;
    note(s);
    note(t);
    for (const auto& [u, v] :
         {std::pair(a, d), std::pair(d, b), std::pair(b, c), std::pair(c, a)}) {
      if (left_of.contains({v, u})) queue.emplace_back(u, v);
    }
    --flips_left;
  }
}

PolygonCut PolygonCutter::Cut(std::span<const Eigen::Vector3d> corners,
                              std::vector<Triangle>& triangles) {
  corners_ = corners;
  triangles.clear();
  is_forced_ = false;
  tests_left_ = kMaxTests;
  const auto count = static_cast<std::int32_t>(corners.size());
  const auto fan = [&] {
    for (std::int32_t i = 2; i < count; ++i) triangles.push_back({0, i - 1, i});
  };
  if (count == 3 || !SetPlane()) {
    fan();
    return PolygonCut::kWhole;
  }
  if (IsConvex()) {
    fan();
    // Most polygons are quadrilaterals: these need no map of their edges.
    if (count == 4) {
      const std::array<Triangle, 2> other = {{{1, 2, 3}, {3, 0, 1}}};
      const double now = std::max(LargestCosine(triangles[0]), LargestCosine(triangles[1]));
      const double then = std::max(LargestCosine(other[0]), LargestCosine(other[1]));
      if (then < now - kLeastGain) triangles.assign(other.begin(), other.end());
      return PolygonCut::kWhole;
    }
  } else if (!ClipEars(triangles)) {
    triangles.clear();
    return PolygonCut::kTooComplex;
  } else if (is_forced_ || !TurnsOnce()) {
    return PolygonCut::kSelfCrossing;
  }
  FlipDiagonals(triangles);
  return PolygonCut::kWhole;
}

}  // namespace ccst::io
