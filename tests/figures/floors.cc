#include "tests/figures/floors.h"

#include <limits>

#include "core/quality/distances.h"

namespace ccst::figures {

Floors FloorsFor(const ReferenceSurface& surface, std::int64_t sample_count) {
  Floors floors;
  if (surface.IsOpen()) {
    floors.min_angle = 18.0;
    floors.below_30 = 0.003;
    floors.hausdorff = 0.02;
  } else if (sample_count >= 4000) {
    floors.capacity_cv = 0.03;
  }
  if (surface.IsCreased()) floors.valence_5_7 = 0.985;
  if (sample_count != 4000) floors.hausdorff = std::numeric_limits<double>::infinity();
  return floors;
}

std::set<std::string, std::less<>> FindMisses(const Figures& figures,
                                              const ReferenceSurface& surface,
                                              std::int64_t sample_count,
                                              std::int64_t closed_loops) {
  const Floors floors = FloorsFor(surface, sample_count);
  const auto loops = static_cast<std::int64_t>(surface.topology().boundary_loops.size());
  const double r_max = quality::HexagonalSpacing(surface.area(), sample_count);
  std::set<std::string, std::less<>> misses;
  // Written so that a figure that is not a number misses.
  const auto require = [&misses](bool holds, std::string_view name) {
    if (!holds) misses.emplace(name);
  };
  require(figures.samples == sample_count, "n");
  require(figures.max_distance <= floors.max_distance, "maxdist");
  require(figures.max_host_error <= floors.max_distance, "host");
  require(figures.defect.empty(), "manifold");
  require(closed_loops >= 0 && closed_loops <= surface.CountLoopsShorterThan(3.0 * r_max),
          "closed");
  require(figures.euler == surface.topology().euler + closed_loops, "euler");
  require(figures.components == surface.topology().components, "comp");
  require(figures.boundary_loops == loops - closed_loops, "loops");
  require(figures.turned_over == 0, "turned");
  require(figures.capacity_cv <= floors.capacity_cv, "cv");
  require(figures.radius_same_side >= floors.radius_same_side, "radius");
  require(figures.min_angle >= floors.min_angle, "minAngle");
  require(figures.below_30 <= floors.below_30, "<30%");
  require(figures.valence_5_7 >= floors.valence_5_7, "valence");
  require(figures.hausdorff <= floors.hausdorff, "hausdorff");
  return misses;
}

}  // namespace ccst::figures
