#include "core/methods/cloud.h"

#include <cmath>

#include "core/random/random.h"
#include "core/spatial/spatial_order.h"

namespace ccst {

void DrawCloud(const Surface& surface, const Density& density, const CapacityCurve& curve,
               std::int64_t size, std::int64_t count, std::uint64_t seed, std::uint64_t stream,
               Interrupt* interrupt, Cloud* cloud) {
  const CounterRandom random(seed, stream);
  const double r_max = HexagonalSpacing(surface, count);
  const double footprint = surface.area() / static_cast<double>(count);
  // Filled by push_back, so that the system's work on fresh pages is spread over the loops.
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::int32_t> faces;
  std::vector<float> spacings;
  positions.reserve(size);
  faces.reserve(size);
  spacings.reserve(size);
  for (std::int64_t i = 0; i < size; ++i) {
    if (interrupt->RequestedAt(i)) return;
    const SurfacePoint point = curve.At(random.Uniform(i) * curve.length());
    positions.push_back(point.position);
    faces.push_back(point.face);
    const double rho = density.At(point.face, point.weights, footprint);
    spacings.push_back(static_cast<float>(r_max / std::sqrt(rho)));
  }
  const std::vector<std::int32_t> order = HilbertOrder(positions, interrupt);
  if (interrupt->Requested()) return;
  cloud->positions.reserve(size);
  cloud->faces.reserve(size);
  cloud->capacities.reserve(size);
  cloud->spacings.reserve(size);
  cloud->draws.resize(size);
  for (std::int64_t k = 0; k < size; ++k) {
    if (interrupt->RequestedAt(k)) return;
    const std::int32_t i = order[k];
    cloud->positions.push_back(positions[i]);
    cloud->faces.push_back(faces[i]);
    cloud->capacities.push_back(random.Uniform(i) * curve.length());
    cloud->spacings.push_back(spacings[i]);
    cloud->draws[i] = static_cast<std::int32_t>(k);
  }
  cloud->tree.Build(cloud->positions);
}

}  // namespace ccst
