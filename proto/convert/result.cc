#include "proto/convert/result.h"

#include "core/base/status.h"
#include "proto/convert/enums.h"
#include "proto/convert/progress.h"
#include "proto/convert/scalars.h"

namespace ccst {
namespace {

v1::SamplingResult Assemble(const SamplingResult& result, const RunRecord& record,
                            std::int64_t sample_count, std::int64_t sample_mesh_face_count) {
  v1::SamplingResult message;
  message.set_termination_reason(ToProto(result.termination));
  if (record.last_report.has_value()) {
    *message.mutable_final_progress() = ToProto(*record.last_report, Phase::kFinalizing);
  }
  message.set_sample_count(sample_count);
  message.set_relative_radius(result.relative_radius);
  message.mutable_samples_digest()->set_sha256(record.samples_sha256);
  message.mutable_samples_digest()->set_size_bytes(record.samples_bytes);
  for (const std::string& warning : record.warnings) message.add_warnings(warning);
  message.set_capacity_cv(result.capacity_cv);
  message.set_energy(result.energy);
  message.set_iteration_count(result.alternations);
  message.set_pass_count(result.passes);
  message.set_sample_mesh_face_count(sample_mesh_face_count);
  *message.mutable_surface() = ToProto(result.surface);
  v1::PhaseDurations* durations = message.mutable_durations();
  *durations->mutable_queue_duration() = DurationToProto(record.queue_seconds);
  *durations->mutable_decode_duration() = DurationToProto(record.decode_seconds);
  *durations->mutable_prepare_duration() = DurationToProto(result.prepare_seconds);
  *durations->mutable_initialize_duration() = DurationToProto(result.initialise_seconds);
  *durations->mutable_optimize_duration() = DurationToProto(result.optimise_seconds);
  *durations->mutable_total_duration() = DurationToProto(record.total_seconds);
  return message;
}

}  // namespace

v1::SurfaceSummary ToProto(const SurfaceSummary& surface) {
  v1::SurfaceSummary message;
  message.set_vertex_count(surface.vertices);
  message.set_face_count(surface.faces);
  message.set_surface_area(surface.area);
  message.set_bounds_diagonal(surface.diagonal);
  message.set_component_count(surface.components);
  message.set_boundary_loop_count(surface.boundary_loops);
  message.set_euler_characteristic(surface.euler);
  message.set_closed_loop_count(surface.closed_loops);
  message.set_welded_vertex_count(surface.repairs.welded_vertices);
  message.set_isolated_vertex_count(surface.repairs.isolated_vertices);
  message.set_repeated_index_face_count(surface.repairs.repeated_index_faces);
  message.set_duplicate_face_count(surface.repairs.duplicate_faces);
  message.set_degenerate_face_count(surface.repairs.degenerate_faces);
  message.set_split_face_count(surface.repairs.split_faces);
  message.set_cut_edge_count(surface.repairs.cut_edges);
  message.set_non_orientable_cut_count(surface.repairs.non_orientable_cuts);
  message.set_cut_vertex_count(surface.repairs.cut_vertices);
  message.set_flipped_face_count(surface.repairs.flipped_faces);
  message.set_untriangulated_component_count(surface.untriangulated_components);
  message.set_untriangulated_sample_count(surface.untriangulated_samples);
  return message;
}

SurfaceSummary FromProto(const v1::SurfaceSummary& surface) {
  SurfaceSummary summary;
  summary.vertices = surface.vertex_count();
  summary.faces = surface.face_count();
  summary.area = surface.surface_area();
  summary.diagonal = surface.bounds_diagonal();
  summary.components = surface.component_count();
  summary.boundary_loops = surface.boundary_loop_count();
  summary.euler = surface.euler_characteristic();
  summary.closed_loops = surface.closed_loop_count();
  summary.repairs.welded_vertices = surface.welded_vertex_count();
  summary.repairs.isolated_vertices = surface.isolated_vertex_count();
  summary.repairs.repeated_index_faces = surface.repeated_index_face_count();
  summary.repairs.duplicate_faces = surface.duplicate_face_count();
  summary.repairs.degenerate_faces = surface.degenerate_face_count();
  summary.repairs.split_faces = surface.split_face_count();
  summary.repairs.cut_edges = surface.cut_edge_count();
  summary.repairs.non_orientable_cuts = surface.non_orientable_cut_count();
  summary.repairs.cut_vertices = surface.cut_vertex_count();
  summary.repairs.flipped_faces = surface.flipped_face_count();
  summary.untriangulated_components = surface.untriangulated_component_count();
  summary.untriangulated_samples = surface.untriangulated_sample_count();
  return summary;
}

v1::SamplingResult ToProto(const SamplingResult& result, const RunRecord& record) {
  return Assemble(result, record, static_cast<std::int64_t>(result.samples.faces.size()),
                  static_cast<std::int64_t>(result.samples.triangles.size()));
}

v1::SamplingResult ToProto(const ResultFigures& figures) {
  return Assemble(figures.result, figures.record, figures.sample_count,
                  figures.sample_mesh_face_count);
}

absl::StatusOr<ResultFigures> FromProto(const v1::SamplingResult& result) {
  const auto termination = FromProto(result.termination_reason());
  if (!termination.has_value()) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                     "unknown termination reason " + std::to_string(result.termination_reason()));
  }
  ResultFigures figures;
  figures.result.termination = *termination;
  figures.result.relative_radius = result.relative_radius();
  figures.result.capacity_cv = result.capacity_cv();
  figures.result.energy = result.energy();
  figures.result.alternations = result.iteration_count();
  figures.result.passes = result.pass_count();
  figures.result.surface = FromProto(result.surface());
  const v1::PhaseDurations& durations = result.durations();
  figures.result.prepare_seconds = SecondsFromProto(durations.prepare_duration());
  figures.result.initialise_seconds = SecondsFromProto(durations.initialize_duration());
  figures.result.optimise_seconds = SecondsFromProto(durations.optimize_duration());
  figures.sample_count = result.sample_count();
  figures.sample_mesh_face_count = result.sample_mesh_face_count();
  RunRecord& record = figures.record;
  if (result.has_final_progress()) record.last_report = FromProto(result.final_progress());
  record.samples_sha256 = result.samples_digest().sha256();
  record.samples_bytes = result.samples_digest().size_bytes();
  record.queue_seconds = SecondsFromProto(durations.queue_duration());
  record.decode_seconds = SecondsFromProto(durations.decode_duration());
  record.total_seconds = SecondsFromProto(durations.total_duration());
  record.warnings.assign(result.warnings().begin(), result.warnings().end());
  return figures;
}

}  // namespace ccst
