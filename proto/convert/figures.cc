#include "proto/convert/figures.h"

#include <cstdint>
#include <numbers>
#include <numeric>

namespace ccst {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

}  // namespace

v1::Curve ToProto(const analysis::Curve& curve) {
  v1::Curve message;
  message.mutable_x()->Add(curve.x.begin(), curve.x.end());
  message.mutable_y()->Add(curve.y.begin(), curve.y.end());
  return message;
}

void AddFigures(const quality::AngleFigures& figures, v1::AnalyzeJobResponse& response) {
  response.set_min_angle_radians(figures.smallest * kRadiansPerDegree);
  response.set_mean_min_angle_radians(figures.mean_smallest * kRadiansPerDegree);
  const auto angles = static_cast<double>(
      std::accumulate(figures.histogram.begin(), figures.histogram.end(), std::int64_t{0}));
  v1::Curve& curve = *response.mutable_angle_histogram();
  double middle = 0.5;
  for (const std::int64_t count : figures.histogram) {
    curve.add_x(middle++ * quality::AngleFigures::kBinWidth * kRadiansPerDegree);
    curve.add_y(static_cast<double>(count) / angles);
  }
}

void AddFigures(const analysis::SampleFigures& figures, v1::AnalyzeJobResponse& response) {
  // A strip far narrower than the spacing shows no pair at any distance.
  if (!figures.radial_mean.x.empty()) {
    *response.mutable_radial_mean() = ToProto(figures.radial_mean);
  }
  if (!figures.anisotropy.x.empty()) *response.mutable_anisotropy() = ToProto(figures.anisotropy);
  *response.mutable_power_spectrum() = ToProto(figures.power_spectrum);
  response.set_effective_nyquist(figures.effective_nyquist);
  response.set_oscillation(figures.oscillation);
  if (!figures.mesh.has_value()) return;
  response.set_voronoi_cv(figures.mesh->voronoi_cv);
  response.set_bond_order(figures.mesh->bond_order);
}

}  // namespace ccst
