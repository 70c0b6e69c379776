#include "core/io/unused_vertices.h"

#include <cstddef>
#include <vector>

namespace ccst::io {

TriangleMesh WithoutExcessVertices(TriangleMesh mesh) {
  if (mesh.positions.size() <= 3 * mesh.faces.size()) return mesh;
  constexpr int kUnused = -1;
  constexpr int kUsed = 0;
  std::vector<int> place(mesh.positions.size(), kUnused);
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const int corner : face) place[static_cast<std::size_t>(corner)] = kUsed;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] == kUnused) continue;
    mesh.positions[kept] = mesh.positions[i];
    place[i] = static_cast<int>(kept++);
  }
  mesh.positions.resize(kept);
  for (Eigen::Vector3i& face : mesh.faces) {
    for (int& corner : face) corner = place[static_cast<std::size_t>(corner)];
  }
  return mesh;
}

}  // namespace ccst::io
