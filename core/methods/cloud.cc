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
  std::vector<Eigen::Vector3d> positions(size);
  std::vector<std::int32_t> faces(size);
  std::vector<float> spacings(size);
  for (std::int64_t i = 0; i < size; ++i) {
    if (interrupt->RequestedAt(i)) return;
    const SurfacePoint point = curve.At(random.Uniform(i) * curve.length());
    positions[i] = point.position;
    faces[i] = point.face;
    spacings[i] =
        static_cast<float>(r_max / std::sqrt(density.At(point.face, point.weights, footprint)));
  }
  const std::vector<std::int32_t> order = HilbertOrder(positions, interrupt);
  if (interrupt->Requested()) return;
  cloud->positions.resize(size);
  cloud->faces.resize(size);
  cloud->capacities.resize(size);
  cloud->spacings.resize(size);
  cloud->draws.resize(size);
  for (std::int64_t k = 0; k < size; ++k) {
    const std::int32_t i = order[k];
    cloud->positions[k] = positions[i];
    cloud->faces[k] = faces[i];
    cloud->capacities[k] = random.Uniform(i) * curve.length();
    cloud->spacings[k] = spacings[i];
    cloud->draws[i] = static_cast<std::int32_t>(k);
  }
  cloud->tree.Build(cloud->positions);
}

}  // namespace ccst
