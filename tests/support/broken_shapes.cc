// Shapes that a sampler has to mend or to refuse.
#include <cmath>
#include <numbers>
#include <utility>

#include "tests/support/shapes.h"

namespace ccst::shapes {

TriangleMesh Unwelded(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const Eigen::Vector3i& t : mesh.faces) {
    const int first = static_cast<int>(soup.positions.size());
    for (const int v : t) soup.positions.push_back(mesh.positions[v]);
    soup.faces.emplace_back(first, first + 1, first + 2);
  }
  return soup;
}

TriangleMesh WithIsolatedVertices(const TriangleMesh& mesh, int count) {
  TriangleMesh padded;
  for (int i = 0; i < count; ++i) padded.positions.emplace_back(0.1 * i, 0.2 * i, 0.3 * i);
  padded.positions.insert(padded.positions.end(), mesh.positions.begin(), mesh.positions.end());
  for (const Eigen::Vector3i& t : mesh.faces) padded.faces.push_back(t.array() + count);
  return padded;
}

TriangleMesh WithFlippedFace(TriangleMesh mesh, int face) {
  std::swap(mesh.faces[face][1], mesh.faces[face][2]);
  return mesh;
}

TriangleMesh ThreeFins() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
}

TriangleMesh TetrahedraSharingVertex() {
  TriangleMesh mesh = Moved(Tetrahedron(), {-1, -1, -1});  // Vertex 0 in the origin.
  // The point reflection of a tetrahedron is inside out.
  for (int v = 1; v < 4; ++v) mesh.positions.push_back(-mesh.positions[v]);
  const auto twin = [](int v) { return v == 0 ? 0 : v + 3; };
  for (int f = 0; f < 4; ++f) {
    const Eigen::Vector3i t = mesh.faces[f];
    mesh.faces.emplace_back(twin(t[0]), twin(t[2]), twin(t[1]));
  }
  return mesh;
}

TriangleMesh MoebiusStrip(int around, int across) {
  TriangleMesh mesh;
  const int stride = across + 1;
  for (int i = 0; i < around; ++i) {
    const double u = 2.0 * std::numbers::pi * i / around;
    for (int j = 0; j <= across; ++j) {
      const double v = static_cast<double>(j) / across - 0.5;
      const double ring = 1.0 + 0.5 * v * std::cos(0.5 * u);
      mesh.positions.emplace_back(ring * std::cos(u), ring * std::sin(u),
                                  0.5 * v * std::sin(0.5 * u));
    }
  }
  // The last column meets the first one upside down.
  const auto corner = [&](int i, int j) { return i < around ? i * stride + j : (across - j); };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      mesh.faces.emplace_back(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1));
      mesh.faces.emplace_back(corner(i, j), corner(i + 1, j + 1), corner(i, j + 1));
    }
  }
  return mesh;
}

}  // namespace ccst::shapes
