#include "core/sampling/face_order.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/spatial/spatial_order.h"

namespace ccst {
namespace {

/// Of the faces' centroids, scaled into the unit cube around the origin.
std::vector<std::int32_t> OrderAlongCurve(const TriangleMesh& mesh, Interrupt* interrupt) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : mesh.positions) box.extend(position);
  const Eigen::Vector3d center = box.center();
  const double extent = box.sizes().maxCoeff();
  const double scale = extent > 0.0 ? 1.0 / extent : 0.0;
  std::vector<Eigen::Vector3d> centroids;
  centroids.reserve(mesh.faces.size());
  for (const Eigen::Vector3i& face : mesh.faces) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(centroids.size()))) return {};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::int32_t v : face) sum += (mesh.positions[v] - center) * scale;
    centroids.emplace_back(sum / 3.0);
  }
  return HilbertOrder(centroids, interrupt);
}

template <typename T>
void Permute(const std::vector<std::int32_t>& order, std::vector<T>* values) {
  std::vector<T> sorted;
  sorted.reserve(values->size());
  for (const std::int32_t i : order) sorted.push_back((*values)[i]);
  values->swap(sorted);
}

}  // namespace

void SortFaces(RepairedMesh* repaired, Interrupt* interrupt) {
  TriangleMesh& mesh = repaired->mesh;
  const std::vector<std::int32_t> order = OrderAlongCurve(mesh, interrupt);
  if (interrupt->Requested()) return;
  Permute(order, &mesh.faces);
  Permute(order, &repaired->source_face);
  Permute(order, &repaired->source_corner);
  std::vector<std::int32_t> number(mesh.positions.size(), -1);
  std::vector<std::int32_t> vertices;
  vertices.reserve(mesh.positions.size());
  for (Eigen::Vector3i& face : mesh.faces) {
    for (std::int32_t& v : face) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(v);
      }
      v = number[v];
    }
  }
  Permute(vertices, &mesh.positions);
}

}  // namespace ccst
