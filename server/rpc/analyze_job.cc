#include "server/rpc/analyze_job.h"

#include "proto/convert/figures.h"

namespace ccst::server {

v1::AnalyzeJobResponse ToProto(const JobFigures& figures) {
  v1::AnalyzeJobResponse response;
  response.set_relative_radius(figures.distances.relative_radius);
  response.set_relative_radius_same_side(figures.distances.relative_radius_same_side);
  response.set_mean_nearest_distance(figures.distances.mean_nearest_distance);
  if (figures.mesh.has_value()) {
    response.set_capacity_cv(figures.mesh->capacity_cv);
    AddFigures(figures.mesh->angles, response);
    response.set_valence_5_7_share(figures.mesh->valences.share_5_to_7);
  }
  if (figures.on_surface.has_value()) AddFigures(*figures.on_surface, response);
  return response;
}

}  // namespace ccst::server
