#include "proto/convert/figures.h"

namespace ccst {

v1::Curve ToProto(const analysis::Curve& curve) {
  v1::Curve message;
  message.mutable_x()->Add(curve.x.begin(), curve.x.end());
  message.mutable_y()->Add(curve.y.begin(), curve.y.end());
  return message;
}

void AddFigures(const analysis::SampleFigures& figures, v1::AnalyzeJobResponse& response) {
  *response.mutable_radial_mean() = ToProto(figures.radial_mean);
  *response.mutable_anisotropy() = ToProto(figures.anisotropy);
  *response.mutable_power_spectrum() = ToProto(figures.power_spectrum);
  response.set_effective_nyquist(figures.effective_nyquist);
  response.set_oscillation(figures.oscillation);
  if (!figures.mesh.has_value()) return;
  response.set_voronoi_cv(figures.mesh->voronoi_cv);
  response.set_bond_order(figures.mesh->bond_order);
}

}  // namespace ccst
