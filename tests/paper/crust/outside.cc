#include "tests/paper/crust/outside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "absl/container/flat_hash_map.h"

namespace ccst {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;  // Increasing.
using EdgeFaces = absl::flat_hash_map<Edge, std::vector<std::int32_t>>;

constexpr double kFullTurn = 2.0 * std::numbers::pi;

Edge MakeEdge(std::int32_t a, std::int32_t b) { return std::minmax(a, b); }

EdgeFaces ConnectEdges(const std::vector<Eigen::Vector3i>& triangles) {
  EdgeFaces faces;
  faces.reserve(2 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      faces[MakeEdge(triangles[t][k], triangles[t][(k + 1) % 3])].push_back(
          static_cast<std::int32_t>(t));
    }
  }
  return faces;
}

std::int32_t Opposite(const Eigen::Vector3i& triangle, const Edge& edge) {
  for (const std::int32_t v : triangle) {
    if (v != edge.first && v != edge.second) return v;
  }
  return -1;
}

/// Angles [0, 2 pi) around the edge from `a` to `b`, counter-clockwise seen from `b`, starting at
/// the direction towards the point `origin`.
class AnglesAround {
 public:
  AnglesAround(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& origin)
      : a_(a), axis_((b - a).normalized()) {
    x_ = Flat(origin).normalized();
    y_ = axis_.cross(x_);
  }
  double Of(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = Flat(point);
    const double angle = std::atan2(d.dot(y_), d.dot(x_));
    return angle < 0.0 ? angle + kFullTurn : angle;
  }

 private:
  Eigen::Vector3d Flat(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = point - a_;
    return d - d.dot(axis_) * axis_;
  }
  Eigen::Vector3d a_;
  Eigen::Vector3d axis_;
  Eigen::Vector3d x_;
  Eigen::Vector3d y_;
};

bool IsSharp(const std::vector<Eigen::Vector3d>& points,
             const std::vector<Eigen::Vector3i>& triangles, const Edge& edge,
             const std::vector<std::int32_t>& faces, bool trim_holes) {
  if (faces.empty()) return false;
  if (faces.size() == 1) return trim_holes;
  const AnglesAround angles(points[edge.first], points[edge.second],
                            points[Opposite(triangles[faces[0]], edge)]);
  std::vector<double> turns = {0.0, kFullTurn};
  for (std::size_t i = 1; i < faces.size(); ++i) {
    turns.push_back(angles.Of(points[Opposite(triangles[faces[i]], edge)]));
  }
  std::sort(turns.begin(), turns.end());
  double widest = 0.0;
  for (std::size_t i = 1; i < turns.size(); ++i) widest = std::max(widest, turns[i] - turns[i - 1]);
  return widest > 1.5 * std::numbers::pi;
}

/// Piece of each triangle, connected through edges; numbered from 0.
std::vector<std::int32_t> FindPieces(const std::vector<Eigen::Vector3i>& triangles,
                                     const EdgeFaces& faces, std::int32_t* count) {
  std::vector<std::int32_t> piece(triangles.size(), -1);
  std::vector<std::int32_t> stack;
  *count = 0;
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (piece[seed] >= 0) continue;
    piece[seed] = *count;
    stack.push_back(static_cast<std::int32_t>(seed));
    while (!stack.empty()) {
      const Eigen::Vector3i& t = triangles[stack.back()];
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        for (const std::int32_t u : faces.at(MakeEdge(t[k], t[(k + 1) % 3]))) {
          if (piece[u] >= 0) continue;
          piece[u] = *count;
          stack.push_back(u);
        }
      }
    }
    ++*count;
  }
  return piece;
}

/// `t` or its mirror image, whichever has (a, b) as an edge in this direction.
Eigen::Vector3i WithEdge(const Eigen::Vector3i& t, std::int32_t a, std::int32_t b) {
  for (int k = 0; k < 3; ++k) {
    if (t[k] == a && t[(k + 1) % 3] == b) return t;
  }
  return {t[0], t[2], t[1]};
}

}  // namespace

void TrimSharpEdges(const std::vector<Eigen::Vector3d>& points, bool trim_holes,
                    std::vector<Eigen::Vector3i>* triangles) {
  EdgeFaces faces = ConnectEdges(*triangles);
  std::vector<std::uint8_t> dropped(triangles->size(), 0);
  std::vector<Edge> queue;
  for (const auto& [edge, _] : faces) queue.push_back(edge);
  std::sort(queue.begin(), queue.end());  // What falls does not depend on how edges are hashed.
  while (!queue.empty()) {
    const Edge edge = queue.back();
    queue.pop_back();
    if (!IsSharp(points, *triangles, edge, faces[edge], trim_holes)) continue;
    for (const std::int32_t t : std::vector<std::int32_t>(faces[edge])) {
      dropped[t] = 1;
      for (int k = 0; k < 3; ++k) {
        const Edge side = MakeEdge((*triangles)[t][k], (*triangles)[t][(k + 1) % 3]);
        std::erase(faces[side], t);
        queue.push_back(side);
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles->size(); ++t) {
    if (!dropped[t]) (*triangles)[kept++] = (*triangles)[t];
  }
  triangles->resize(kept);
}

std::vector<Eigen::Vector3i> WalkOutside(const std::vector<Eigen::Vector3d>& points,
                                         const std::vector<Eigen::Vector3i>& triangles) {
  const EdgeFaces faces = ConnectEdges(triangles);
  std::int32_t count = 0;
  const std::vector<std::int32_t> piece = FindPieces(triangles, faces, &count);

  // The rightmost point of a piece is on its outside, so is its edge that falls back the least, and
  // of the triangles there the one that faces the right most.
  std::vector<std::int32_t> start(count, -1);
  std::vector<std::array<double, 3>> best(count, {-HUGE_VAL, 0.0, 0.0});
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Eigen::Vector3i& corners = triangles[t];
    const Eigen::Vector3d normal = (points[corners[1]] - points[corners[0]])
                                       .cross(points[corners[2]] - points[corners[0]])
                                       .normalized();
    for (const std::int32_t v : corners) {
      for (const std::int32_t w : corners) {
        if (v == w) continue;
        const Eigen::Vector3d edge = (points[w] - points[v]).normalized();
        const std::array<double, 3> merit = {points[v].x(), edge.x(), std::abs(normal.x())};
        if (merit <= best[piece[t]]) continue;
        best[piece[t]] = merit;
        start[piece[t]] = static_cast<std::int32_t>(t);
      }
    }
  }

  std::vector<Eigen::Vector3i> outside;
  std::vector<std::uint8_t> seen(2 * triangles.size(), 0);  // As stored, and mirrored.
  std::vector<std::pair<std::int32_t, Eigen::Vector3i>> stack;
  const auto visit = [&](std::int32_t t, const Eigen::Vector3i& oriented) {
    std::uint8_t& mark =
        seen[2 * t + (WithEdge(triangles[t], oriented[0], oriented[1]) == triangles[t] ? 0 : 1)];
    if (std::exchange(mark, 1)) return;
    outside.push_back(oriented);
    stack.emplace_back(t, oriented);
  };
  for (std::int32_t p = 0; p < count; ++p) {
    const Eigen::Vector3i& t = triangles[start[p]];
    const double x = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).x();
    visit(start[p], x > 0.0 ? t : Eigen::Vector3i(t[0], t[2], t[1]));
    while (!stack.empty()) {
      const auto [from, oriented] = stack.back();
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = oriented[k];
        const std::int32_t b = oriented[(k + 1) % 3];
        const Edge edge = MakeEdge(a, b);
        // Outside lies counter-clockwise of the triangle around its edge: the next one that way.
        const AnglesAround angles(points[a], points[b], points[oriented[(k + 2) % 3]]);
        std::int32_t next = -1;
        double least = kFullTurn;
        for (const std::int32_t u : faces.at(edge)) {
          if (u == from) continue;
          const double turn = angles.Of(points[Opposite(triangles[u], edge)]);
          if (turn < least) {
            least = turn;
            next = u;
          }
        }
        if (next >= 0) visit(next, WithEdge(triangles[next], b, a));
      }
    }
  }
  return outside;
}

}  // namespace ccst
