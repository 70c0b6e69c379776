#include "core/quality/bond_order.h"

#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

namespace ccst::quality {
namespace {

// A triangle at a vertex: from the edge to `from` to the edge to `to`.
struct Wedge {
  std::int32_t from;
  std::int32_t to;
  double angle;
};

// The order of one vertex; negative where its triangles do not close around it.
double OrderOf(const std::vector<Wedge>& wedges) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double total = 0.0;
  for (const Wedge& wedge : wedges) total += wedge.angle;
  if (wedges.size() < 3 || !(total > 0.0)) return -1.0;
  std::complex<double> sum = 0.0;
  double direction = 0.0;
  std::int32_t at = wedges.front().from;
  for (std::size_t step = 0; step < wedges.size(); ++step) {
    const Wedge* next = nullptr;
    for (const Wedge& wedge : wedges) {
      if (wedge.from == at) next = &wedge;
    }
    if (next == nullptr) return -1.0;
    sum += std::polar(1.0, 6.0 * direction);
    direction += next->angle / total * kTurn;
    at = next->to;
  }
  if (at != wedges.front().from) return -1.0;
  return std::abs(sum) / static_cast<double>(wedges.size());
}

}  // namespace

double MeasureBondOrder(std::span<const Eigen::Vector3d> positions,
                        std::span<const Eigen::Vector3i> triangles) {
  std::vector<std::vector<Wedge>> rings(positions.size());
  for (const Eigen::Vector3i& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = t[(k + 1) % 3];
      const std::int32_t to = t[(k + 2) % 3];
      const Eigen::Vector3d a = positions[from] - positions[t[k]];
      const Eigen::Vector3d b = positions[to] - positions[t[k]];
      rings[static_cast<std::size_t>(t[k])].push_back(
          {from, to, std::atan2(a.cross(b).norm(), a.dot(b))});
    }
  }
  double sum = 0.0;
  double counted = 0.0;
  for (const std::vector<Wedge>& ring : rings) {
    const double order = OrderOf(ring);
    if (order < 0.0) continue;
    sum += order;
    counted += 1.0;
  }
  return counted > 0.0 ? sum / counted : 0.0;
}

}  // namespace ccst::quality
