#include "tests/core/analysis/torus_sets.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/random/random.h"

namespace ccst::torus {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d Wrapped(const Eigen::Vector2d& p) {
  return (p.array() - p.array().floor()).matrix();
}

// Finds points by the squares of a grid.
class Grid {
 public:
  Grid(const Points& points, double cell) : size_(std::max(3, static_cast<int>(1.0 / cell))) {
    squares_.resize(static_cast<std::size_t>(size_) * size_);
    for (std::size_t i = 0; i < points.size(); ++i) Add(points[i], static_cast<int>(i));
  }
  void Add(const Eigen::Vector2d& p, int index) {
    At(Column(p.x()), Column(p.y())).push_back(index);
  }
  // Calls `visit` for all points in the squares at most `rings` away, and maybe more.
  template <typename F>
  void ForEachNear(const Eigen::Vector2d& p, int rings, F&& visit) {
    for (int dy = -rings; dy <= rings; ++dy) {
      for (int dx = -rings; dx <= rings; ++dx) {
        for (const int i : At(Column(p.x()) + dx, Column(p.y()) + dy)) visit(i);
      }
    }
  }

 private:
  int Column(double x) const { return std::min(size_ - 1, static_cast<int>(x * size_)); }
  std::vector<int>& At(int x, int y) {
    return squares_[static_cast<std::size_t>((y + size_) % size_) * size_ + (x + size_) % size_];
  }
  int size_;
  std::vector<std::vector<int>> squares_;
};

}  // namespace

Eigen::Vector2d Difference(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  Eigen::Vector2d d = to - from;
  return (d.array() - d.array().round()).matrix();
}

Cells MakeCells(const Points& points) {
  struct Corner {
    Eigen::Vector2d place;  // Relative to the point.
    int neighbour;          // Beyond the side that starts here.
  };
  const auto count = static_cast<int>(points.size());
  Cells cells;
  Grid grid(points, 1.0 / std::sqrt(count));
  std::vector<std::pair<double, int>> near;
  for (int i = 0; i < count; ++i) {
    std::vector<Corner> cell;
    // White noise has holes: look farther until the cell ends well before what was looked at.
    for (int rings = 4;; rings *= 2) {
      near.clear();
      grid.ForEachNear(points[i], rings, [&](int j) {
        if (j != i) near.emplace_back(Difference(points[i], points[j]).squaredNorm(), j);
      });
      std::sort(near.begin(), near.end());
      cell = {{{-.5, -.5}, -1}, {{.5, -.5}, -1}, {{.5, .5}, -1}, {{-.5, .5}, -1}};
      double farthest = 0.5;
      for (const auto& [squared, j] : near) {
        if (squared > 4.0 * farthest) break;
        const Eigen::Vector2d d = Difference(points[i], points[j]);
        const auto beyond = [&](const Corner& c) { return c.place.dot(d) > 0.5 * squared; };
        std::vector<Corner> rest;
        for (std::size_t k = 0; k < cell.size(); ++k) {
          const Corner& a = cell[k];
          const Corner& b = cell[(k + 1) % cell.size()];
          if (!beyond(a)) rest.push_back(a);
          if (beyond(a) == beyond(b)) continue;
          const double t = (0.5 * squared - a.place.dot(d)) / (b.place - a.place).dot(d);
          rest.push_back({a.place + t * (b.place - a.place), beyond(b) ? j : a.neighbour});
        }
        cell = rest;
        farthest = 0.0;
        for (const Corner& c : cell) farthest = std::max(farthest, c.place.squaredNorm());
      }
      if (4.0 * farthest < rings * rings / static_cast<double>(count)) break;
    }
    double area = 0.0;
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const Corner& a = cell[k];
      const Corner& b = cell[(k + 1) % cell.size()];
      const double part = 0.5 * Cross(a.place, b.place);
      area += part;
      centroid += part / 3.0 * (a.place + b.place);
      // The corner between two sides is the centre of a Delaunay triangle's circle.
      const Eigen::Vector3i t(i, a.neighbour, b.neighbour);
      if (i < t[1] && i < t[2]) cells.triangles.push_back(t);
    }
    cells.areas.push_back(area);
    cells.centroids.push_back(centroid / area);
  }
  return cells;
}

Unrolled Unroll(const Points& points, const std::vector<Eigen::Vector3i>& triangles) {
  Unrolled mesh;
  for (const Eigen::Vector3i& t : triangles) {
    const auto first = static_cast<int>(mesh.positions.size());
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d p = points[t[0]] + Difference(points[t[0]], points[t[k]]);
      mesh.positions.emplace_back(p.x(), p.y(), 0.0);
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

Points WhiteNoise(int count, std::uint64_t seed) {
  const CounterRandom random(seed, 1);
  Points points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(random.Uniform(2 * i), random.Uniform(2 * i + 1));
  }
  return points;
}

Points DartThrowing(int count, std::uint64_t seed) {
  const CounterRandom random(seed, 2);
  double radius = 0.77 * std::sqrt(2.0 / (std::sqrt(3.0) * count));
  Points points;
  Grid grid(points, radius);
  int in_vain = 0;
  for (std::uint64_t dart = 0; static_cast<int>(points.size()) < count; ++dart) {
    const Eigen::Vector2d p(random.Uniform(2 * dart), random.Uniform(2 * dart + 1));
    bool free = true;
    grid.ForEachNear(p, 1,
                     [&](int j) { free = free && Difference(p, points[j]).norm() >= radius; });
    if (free) {
      grid.Add(p, static_cast<int>(points.size()));
      points.push_back(p);
      in_vain = 0;
    } else if (++in_vain == 1000) {
      radius *= 0.999;
      in_vain = 0;
    }
  }
  return points;
}

Points Lloyd(int count, int steps, std::uint64_t seed) {
  Points points = WhiteNoise(count, seed);
  for (int step = 0; step < steps; ++step) {
    const Cells cells = MakeCells(points);
    for (int i = 0; i < count; ++i) points[i] = Wrapped(points[i] + cells.centroids[i]);
  }
  return points;
}

Points Ccdt(int count, int alternations, std::uint64_t seed) {
  constexpr int kPasses = 20;
  constexpr double kStep = 1.5;  // Over-relaxed: as even as with three times the passes.
  Points points = WhiteNoise(count, seed);
  for (int alternation = 0; alternation < alternations; ++alternation) {
    const std::vector<Eigen::Vector3i> triangles = MakeCells(points).triangles;
    std::vector<std::vector<Eigen::Vector2i>> rings(points.size());
    for (const Eigen::Vector3i& t : triangles) {
      for (int k = 0; k < 3; ++k) rings[t[k]].emplace_back(t[(k + 1) % 3], t[(k + 2) % 3]);
    }
    for (int pass = 0; pass < kPasses; ++pass) {
      for (int i = 0; i < count; ++i) {
        // Twice the area is linear in the point: x = c + g . p. The sum of x^2 has its minimum
        // where M p = -b.
        Eigen::Matrix2d m = Eigen::Matrix2d::Zero();
        Eigen::Vector2d b = Eigen::Vector2d::Zero();
        for (const Eigen::Vector2i& side : rings[i]) {
          const Eigen::Vector2d p = Difference(points[i], points[side[0]]);
          const Eigen::Vector2d q = Difference(points[i], points[side[1]]);
          const Eigen::Vector2d g(p.y() - q.y(), q.x() - p.x());
          m += g * g.transpose();
          b += g * Cross(p, q);
        }
        Eigen::Vector2d move = -kStep * (m.inverse() * b);
        // Half of it as often as a triangle would turn over.
        const auto turns = [&](const Eigen::Vector2d& d) {
          return std::any_of(rings[i].begin(), rings[i].end(), [&](const Eigen::Vector2i& side) {
            return Cross(Difference(points[i], points[side[0]]) - d,
                         Difference(points[i], points[side[1]]) - d) <= 0.0;
          });
        };
        for (int halving = 0; halving < 8 && turns(move); ++halving) move *= 0.5;
        if (!turns(move)) points[i] = Wrapped(points[i] + move);
      }
    }
  }
  return points;
}

}  // namespace ccst::torus
