#include "core/sampling/input/face_order.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/spatial/spatial_order.h"

namespace ccst::internal {
namespace {

/// Faces or vertices that one thread works on in one go.
constexpr std::int64_t kPiece = 8192;

/// Of the faces' centroids, scaled into the unit cube around the origin.
std::vector<std::int32_t> OrderAlongCurve(const TriangleMesh& mesh, const Parallel& parallel,
                                          Interrupt* interrupt) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : mesh.positions) box.extend(position);
  const Eigen::Vector3d center = box.center();
  const double extent = box.sizes().maxCoeff();
  const double scale = extent > 0.0 ? 1.0 / extent : 0.0;
  std::vector<Eigen::Vector3d> centroids(mesh.faces.size());
  parallel.ForRanges(static_cast<std::int64_t>(mesh.faces.size()), kPiece,
                     [&](std::int64_t first, std::int64_t end) {
                       for (auto f = static_cast<std::size_t>(first);
                            f < static_cast<std::size_t>(end); ++f) {
                         Eigen::Vector3d sum = Eigen::Vector3d::Zero();
                         for (const std::int32_t v : mesh.faces[f]) {
                           sum += (mesh.positions[v] - center) * scale;
                         }
                         centroids[f] = sum / 3.0;
                       }
                     });
  return HilbertOrder(centroids, interrupt, parallel);
}

template <typename T>
void Permute(const std::vector<std::int32_t>& order, const Parallel& parallel,
             std::vector<T>* values) {
  std::vector<T> sorted(order.size());
  parallel.ForRanges(
      static_cast<std::int64_t>(order.size()), kPiece, [&](std::int64_t first, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
          sorted[i] = (*values)[order[i]];
        }
      });
  values->swap(sorted);
}

}  // namespace

void SortFaces(RepairedMesh* repaired, Interrupt* interrupt, const Parallel& parallel) {
  TriangleMesh& mesh = repaired->mesh;
  const std::vector<std::int32_t> order = OrderAlongCurve(mesh, parallel, interrupt);
  if (interrupt->Requested()) return;
  Permute(order, parallel, &mesh.faces);
  Permute(order, parallel, &repaired->source_face);
  Permute(order, parallel, &repaired->source_corner);
  std::vector<std::int32_t> number(mesh.positions.size(), -1);
  std::vector<std::int32_t> vertices;
  vertices.reserve(mesh.positions.size());
  for (Eigen::Vector3i& face : mesh.faces) {
    if (interrupt->RequestedAfter(1)) return;
    for (std::int32_t& v : face) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(vertices.size());
        vertices.push_back(v);
      }
      v = number[v];
    }
  }
  Permute(vertices, parallel, &mesh.positions);
}

}  // namespace ccst::internal
