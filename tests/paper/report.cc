#include "tests/paper/report.h"

#include <vector>

#include "core/analysis/reference_surface.h"
#include "core/analysis/sample_figures.h"

namespace ccst::paper {

nlohmann::json ReportFigures(const Surface& surface, std::span<const SampleSet> sets) {
  const analysis::ReferenceSurface reference(surface, Density::Uniform(surface));
  std::vector<analysis::SampleSetView> views;
  for (const SampleSet& set : sets) views.push_back({set.positions, set.triangles});
  const analysis::SampleFigures figures = analysis::MeasureSamples(reference, views);
  const auto curve = [](const analysis::Curve& c) {
    return nlohmann::json{{"x", c.x}, {"y", c.y}};
  };
  nlohmann::json report = {{"radius", figures.relative_radius_same_side},
                           {"nearest", figures.mean_nearest_distance},
                           {"radial_mean", curve(figures.radial_mean)},
                           {"anisotropy", curve(figures.anisotropy)}};
  if (figures.mesh.has_value()) {
    report["cv"] = figures.mesh->capacity_cv;
    report["min_angle"] = figures.mesh->smallest_angle;
    report["below_30"] = figures.mesh->share_below_30;
    report["valence_5_7"] = figures.mesh->valence_5_7;
    report["hausdorff"] = figures.mesh->hausdorff.value_or(0.0);
  }
  return report;
}

}  // namespace ccst::paper
