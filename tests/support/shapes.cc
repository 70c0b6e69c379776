#include "tests/support/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace ccst::shapes {
namespace {

constexpr double kPi = std::numbers::pi;

void AddQuad(TriangleMesh& mesh, int a, int b, int c, int d) {
  mesh.faces.emplace_back(a, b, c);
  mesh.faces.emplace_back(a, c, d);
}

// A grid of quads with corners numbered row by row, `stride` a row; columns wrap around when
// `closed`. Faces (right, up).
void AddGrid(TriangleMesh& mesh, int rows, int columns, bool closed) {
  const int stride = closed ? columns : columns + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int right = (column + 1) % stride;
      AddQuad(mesh, row * stride + column, row * stride + right, (row + 1) * stride + right,
              (row + 1) * stride + column);
    }
  }
}

Eigen::Vector3d OnSphere(double polar, double azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
          std::cos(polar)};
}

// Moves each vertex to the mean of itself and its neighbours' mean.
void Smooth(TriangleMesh& mesh) {
  std::vector<Eigen::Vector3d> sums(mesh.positions.size(), Eigen::Vector3d::Zero());
  std::vector<double> counts(mesh.positions.size(), 0.0);
  for (const Eigen::Vector3i& t : mesh.faces) {
    for (int slot = 0; slot < 3; ++slot) {
      sums[t[slot]] += mesh.positions[t[(slot + 1) % 3]];
      counts[t[slot]] += 1.0;
    }
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    mesh.positions[v] = 0.5 * (mesh.positions[v] + sums[v] / counts[v]);
  }
}

}  // namespace

TriangleMesh Tetrahedron() {
  return {{{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

TriangleMesh Cube() {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
  }
  AddQuad(mesh, 0, 2, 3, 1);
  AddQuad(mesh, 4, 5, 7, 6);
  AddQuad(mesh, 0, 1, 5, 4);
  AddQuad(mesh, 2, 6, 7, 3);
  AddQuad(mesh, 0, 4, 6, 2);
  AddQuad(mesh, 1, 3, 7, 5);
  return mesh;
}

TriangleMesh Icosphere(int levels, double radius) {
  TriangleMesh mesh;
  const double g = std::numbers::phi;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level <= levels; ++level) {
    if (level > 0) mesh = Subdivided(mesh);
    for (Eigen::Vector3d& p : mesh.positions) p *= radius / p.norm();
  }
  return mesh;
}

TriangleMesh UvSphere(int rows, int columns, double radius) {
  TriangleMesh mesh;
  for (int row = 1; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      mesh.positions.push_back(radius *
                               OnSphere(kPi * (rows - row) / rows, 2.0 * kPi * column / columns));
    }
  }
  AddGrid(mesh, rows - 2, columns, true);
  const int south = static_cast<int>(mesh.positions.size());
  mesh.positions.emplace_back(0, 0, -radius);
  mesh.positions.emplace_back(0, 0, radius);
  for (int column = 0; column < columns; ++column) {
    const int right = (column + 1) % columns;
    const int top = (rows - 2) * columns;
    mesh.faces.emplace_back(south, right, column);
    mesh.faces.emplace_back(south + 1, top + column, top + right);
  }
  return mesh;
}

TriangleMesh Torus(double large_radius, double small_radius, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < across; ++i) {
    const double v = 2.0 * kPi * i / across;
    for (int j = 0; j < around; ++j) {
      const double u = 2.0 * kPi * j / around;
      const double ring = large_radius + small_radius * std::cos(v);
      mesh.positions.emplace_back(ring * std::cos(u), ring * std::sin(u),
                                  small_radius * std::sin(v));
    }
  }
  AddGrid(mesh, across, around, true);
  const int count = static_cast<int>(mesh.positions.size());
  for (Eigen::Vector3i& t : mesh.faces) {
    for (int& v : t) v %= count;  // The last row is the first.
  }
  return mesh;
}

TriangleMesh PlateWithHoles(int holes, int levels, int smoothing) {
  const Eigen::Vector3i size(2 * holes + 1, 3, 1);
  const auto filled = [&size](const Eigen::Vector3i& cell) {
    if (cell.minCoeff() < 0 || (size - cell).minCoeff() <= 0) return false;
    return cell.y() != 1 || cell.x() % 2 == 0;
  };
  TriangleMesh mesh;
  std::map<std::array<int, 3>, int> index;
  const auto corner = [&](const Eigen::Vector3i& p) {
    const auto [entry, is_new] =
        index.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(p.cast<double>());
    return entry->second;
  };
  for (int x = 0; x < size.x(); ++x) {
    for (int y = 0; y < size.y(); ++y) {
      const Eigen::Vector3i cell(x, y, 0);
      if (!filled(cell)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3i n = Eigen::Vector3i::Unit(axis);
        const Eigen::Vector3i s = Eigen::Vector3i::Unit((axis + 1) % 3);
        const Eigen::Vector3i t = Eigen::Vector3i::Unit((axis + 2) % 3);
        if (!filled(cell + n)) {
          const Eigen::Vector3i o = cell + n;
          AddQuad(mesh, corner(o), corner(o + s), corner(o + s + t), corner(o + t));
        }
        if (!filled(cell - n)) {
          const Eigen::Vector3i o = cell;
          AddQuad(mesh, corner(o), corner(o + t), corner(o + s + t), corner(o + s));
        }
      }
    }
  }
  for (int level = 0; level < levels; ++level) mesh = Subdivided(mesh);
  for (int step = 0; step < smoothing; ++step) Smooth(mesh);
  return mesh;
}

TriangleMesh Cylinder(double radius, double height, int around, int along) {
  TriangleMesh mesh;
  for (int row = 0; row <= along; ++row) {
    for (int column = 0; column < around; ++column) {
      const double u = 2.0 * kPi * column / around;
      mesh.positions.emplace_back(radius * std::cos(u), radius * std::sin(u), height * row / along);
    }
  }
  AddGrid(mesh, along, around, true);
  return mesh;
}

TriangleMesh PlaneGrid(double width, double height, int columns, int rows) {
  TriangleMesh mesh;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      mesh.positions.emplace_back(width * column / columns, height * row / rows, 0.0);
    }
  }
  AddGrid(mesh, rows, columns, false);
  return mesh;
}

TriangleMesh Saddle(int cells) {
  TriangleMesh mesh = Moved(PlaneGrid(2.0, 2.0, cells, cells), {-1.0, -1.0, 0.0});
  for (Eigen::Vector3d& p : mesh.positions) p.z() = p.x() * p.x() - p.y() * p.y();
  return mesh;
}

TriangleMesh SphereWithHole(double hole_angle, int rows, int columns, double radius) {
  TriangleMesh mesh;
  for (int row = 1; row <= rows; ++row) {
    const double polar = kPi + (hole_angle - kPi) * row / rows;
    for (int column = 0; column < columns; ++column) {
      mesh.positions.push_back(radius * OnSphere(polar, 2.0 * kPi * column / columns));
    }
  }
  AddGrid(mesh, rows - 1, columns, true);
  const int south = static_cast<int>(mesh.positions.size());
  mesh.positions.emplace_back(0, 0, -radius);
  for (int column = 0; column < columns; ++column) {
    mesh.faces.emplace_back(south, (column + 1) % columns, column);
  }
  return mesh;
}

TriangleMesh SingleTriangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

TriangleMesh DisjointUnion(std::span<const TriangleMesh> meshes) {
  TriangleMesh all;
  for (const TriangleMesh& mesh : meshes) {
    const int first = static_cast<int>(all.positions.size());
    all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const Eigen::Vector3i& t : mesh.faces) all.faces.push_back(t.array() + first);
  }
  return all;
}

TriangleMesh Moved(TriangleMesh mesh, const Eigen::Vector3d& offset, double scale) {
  for (Eigen::Vector3d& p : mesh.positions) p = scale * p + offset;
  return mesh;
}

TriangleMesh Subdivided(const TriangleMesh& mesh) {
  TriangleMesh fine;
  fine.positions = mesh.positions;
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [entry, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<int>(fine.positions.size()));
    if (is_new) fine.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    return entry->second;
  };
  for (const Eigen::Vector3i& t : mesh.faces) {
    const int ab = middle(t[0], t[1]);
    const int bc = middle(t[1], t[2]);
    const int ca = middle(t[2], t[0]);
    fine.faces.emplace_back(t[0], ab, ca);
    fine.faces.emplace_back(ab, t[1], bc);
    fine.faces.emplace_back(ca, bc, t[2]);
    fine.faces.emplace_back(ab, bc, ca);
  }
  return fine;
}

}  // namespace ccst::shapes
