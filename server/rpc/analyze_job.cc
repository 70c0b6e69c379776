#include "server/rpc/analyze_job.h"

#include <numbers>
#include <utility>
#include <vector>

#include "core/analysis/sample_figures.h"
#include "core/base/status.h"
#include "core/quality/distances.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/repair/repair.h"
#include "proto/convert/figures.h"

namespace ccst::server {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

// Curves over the sample mesh, which lies on the surface and is at hand where the mesh that was
// sampled may be gone. One whose samples all lie on a line is no surface and has none.
absl::Status AddCurves(const std::vector<Eigen::Vector3d>& positions,
                       const std::vector<Eigen::Vector3i>& triangles,
                       v1::AnalyzeJobResponse& response) {
  CCST_ASSIGN_OR_RETURN(RepairedMesh repaired, Repair({positions, triangles}));
  CCST_ASSIGN_OR_RETURN(Surface surface, Surface::Build(repaired.mesh));
  Density uniform = Density::Uniform(surface);
  const analysis::ReferenceSurface reference(std::move(surface), std::move(uniform));
  const analysis::SampleSetView set = {positions, triangles};
  AddFigures(analysis::MeasureSamples(reference, {&set, 1}, {.surface_distance = false}), response);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::AnalyzeJobResponse> Analyze(const JobSupport& support, const Job& job) {
  auto stored = support.jobs.OpenSamples(job);
  if (!stored.ok()) return stored.status();
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples, stored->ReadSamples(0, stored->sample_count()));
  SampleSet mesh;
  CCST_ASSIGN_OR_RETURN(mesh, stored->ReadTriangles(0, stored->triangle_count()));
  const SamplingResult& run = job.View().result->run;
  v1::AnalyzeJobResponse response;
  const quality::DistanceFigures distances =
      quality::MeasureDistances(samples.positions, samples.normals, run.surface.area);
  response.set_relative_radius(distances.relative_radius);
  response.set_relative_radius_same_side(distances.relative_radius_same_side);
  response.set_mean_nearest_distance(distances.mean_nearest_distance);
  if (mesh.triangles.empty()) return response;
  response.set_capacity_cv(run.capacity_cv);
  const quality::AngleFigures angles = quality::MeasureAngles(samples.positions, mesh.triangles);
  response.set_min_angle_radians(angles.smallest * kRadiansPerDegree);
  response.set_mean_min_angle_radians(angles.mean_smallest * kRadiansPerDegree);
  response.set_valence_5_7_share(
      quality::MeasureValences(stored->sample_count(), mesh.triangles).share_5_to_7);
  if (job.spec().options.density.source == DensitySource::kUniform) {
    const absl::Status curves = AddCurves(samples.positions, mesh.triangles, response);
    if (!curves.ok() && GetErrorReason(curves) != ErrorReason::kMeshEmpty) return curves;
  }
  return response;
}

}  // namespace ccst::server
