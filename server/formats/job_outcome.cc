#include "server/formats/job_outcome.h"

#include <array>
#include <utility>

#include "ccst/store/v1/record.pb.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "proto/convert/error_reasons.h"
#include "server/formats/reports.h"
#include "server/formats/stored_message.h"

namespace ccst::server {
namespace {

using internal::Read;
using internal::Write;

constexpr auto kPhases = std::to_array<std::pair<Phase, store::v1::Phase>>(
    {{Phase::kPreparing, store::v1::PHASE_PREPARING},
     {Phase::kInitializing, store::v1::PHASE_INITIALIZING},
     {Phase::kRelaxing, store::v1::PHASE_RELAXING},
     {Phase::kFinalizing, store::v1::PHASE_FINALIZING}});
constexpr auto kTerminations = std::to_array<std::pair<Termination, store::v1::Termination>>(
    {{Termination::kConverged, store::v1::TERMINATION_CONVERGED},
     {Termination::kIterationLimit, store::v1::TERMINATION_ITERATION_LIMIT},
     {Termination::kTimeLimit, store::v1::TERMINATION_TIME_LIMIT},
     {Termination::kStopped, store::v1::TERMINATION_STOPPED}});

// The message's value that stands for `value`; its first, unspecified, for one that is new.
template <typename Pairs, typename Value>
auto MessageOf(const Pairs& pairs, Value value) {
  for (const auto& [ours, stored] : pairs) {
    if (ours == value) return stored;
  }
  return decltype(pairs.front().second){};
}

// The reverse; empty for one this version does not know.
template <typename Pairs, typename Value>
auto ValueOf(const Pairs& pairs, Value value) {
  std::optional<std::remove_cvref_t<decltype(pairs.front().first)>> found;
  for (const auto& [ours, stored] : pairs) {
    if (stored == value) found = ours;
  }
  return found;
}

void Write(const SurfaceSummary& surface, store::v1::Surface& message) {
  message.set_vertices(surface.vertices);
  message.set_faces(surface.faces);
  message.set_area(surface.area);
  message.set_diagonal(surface.diagonal);
  message.set_components(surface.components);
  message.set_boundary_loops(surface.boundary_loops);
  message.set_creases(surface.creases);
  message.set_euler(surface.euler);
  message.set_closed_loops(surface.closed_loops);
  message.set_untriangulated_components(surface.untriangulated_components);
  message.set_untriangulated_samples(surface.untriangulated_samples);
  const RepairReport& repairs = surface.repairs;
  message.set_welded_vertices(repairs.welded_vertices);
  message.set_repeated_index_faces(repairs.repeated_index_faces);
  message.set_duplicate_faces(repairs.duplicate_faces);
  message.set_degenerate_faces(repairs.degenerate_faces);
  message.set_split_faces(repairs.split_faces);
  message.set_cut_edges(repairs.cut_edges);
  message.set_non_orientable_cuts(repairs.non_orientable_cuts);
  message.set_cut_vertices(repairs.cut_vertices);
  message.set_flipped_faces(repairs.flipped_faces);
  message.set_isolated_vertices(repairs.isolated_vertices);
}

SurfaceSummary Read(const store::v1::Surface& message) {
  return {.vertices = message.vertices(),
          .faces = message.faces(),
          .area = message.area(),
          .diagonal = message.diagonal(),
          .components = message.components(),
          .boundary_loops = message.boundary_loops(),
          .creases = message.creases(),
          .euler = message.euler(),
          .closed_loops = message.closed_loops(),
          .untriangulated_components = message.untriangulated_components(),
          .untriangulated_samples = message.untriangulated_samples(),
          .repairs = {.welded_vertices = message.welded_vertices(),
                      .repeated_index_faces = message.repeated_index_faces(),
                      .duplicate_faces = message.duplicate_faces(),
                      .degenerate_faces = message.degenerate_faces(),
                      .split_faces = message.split_faces(),
                      .cut_edges = message.cut_edges(),
                      .non_orientable_cuts = message.non_orientable_cuts(),
                      .cut_vertices = message.cut_vertices(),
                      .flipped_faces = message.flipped_faces(),
                      .isolated_vertices = message.isolated_vertices()}};
}

void Write(const JobResult& result, store::v1::Result& message) {
  message.set_termination(MessageOf(kTerminations, result.run.termination));
  message.set_sample_count(result.sample_count);
  message.set_triangle_count(result.triangle_count);
  message.set_samples_sha256(result.samples_sha256);
  message.set_samples_bytes(result.samples_bytes);
  message.set_alternations(result.run.alternations);
  message.set_passes(result.run.passes);
  message.set_energy(result.run.energy);
  message.set_capacity_cv(result.run.capacity_cv);
  message.set_relative_radius(result.run.relative_radius);
  message.set_queue_seconds(result.queue_seconds);
  message.set_decode_seconds(result.decode_seconds);
  message.set_prepare_seconds(result.run.prepare_seconds);
  message.set_initialise_seconds(result.run.initialise_seconds);
  message.set_optimise_seconds(result.run.optimise_seconds);
  message.set_total_seconds(result.total_seconds);
  message.mutable_warnings()->Assign(result.warnings.begin(), result.warnings.end());
  Write(result.run.surface, *message.mutable_surface());
}

absl::StatusOr<std::shared_ptr<const JobResult>> Read(const store::v1::Result& message) {
  const auto termination = ValueOf(kTerminations, message.termination());
  if (!termination.has_value()) return internal::DamagedRecord("result of a job is");
  auto result = std::make_shared<JobResult>();
  result->run.surface = Read(message.surface());
  result->run.termination = *termination;
  result->run.alternations = message.alternations();
  result->run.passes = message.passes();
  result->run.energy = message.energy();
  result->run.capacity_cv = message.capacity_cv();
  result->run.relative_radius = message.relative_radius();
  result->run.prepare_seconds = message.prepare_seconds();
  result->run.initialise_seconds = message.initialise_seconds();
  result->run.optimise_seconds = message.optimise_seconds();
  result->sample_count = message.sample_count();
  result->triangle_count = message.triangle_count();
  result->samples_sha256 = message.samples_sha256();
  result->samples_bytes = message.samples_bytes();
  result->queue_seconds = message.queue_seconds();
  result->decode_seconds = message.decode_seconds();
  result->total_seconds = message.total_seconds();
  result->warnings.assign(message.warnings().begin(), message.warnings().end());
  return result;
}

void Write(const absl::Status& error, store::v1::Error& message) {
  message.set_code(static_cast<int>(error.code()));
  message.set_message(std::string(error.message()));
  if (const auto reason = GetErrorReason(error)) {
    message.set_reason(std::string(ErrorReasonName(*reason)));
  }
  if (const auto passed = GetPassedLimit(error)) {
    message.mutable_passed_limit()->set_name(passed->name);
    message.mutable_passed_limit()->set_value(passed->value);
    message.mutable_passed_limit()->set_requested(passed->requested);
  }
}

absl::Status Read(const store::v1::Error& message) {
  const auto code = static_cast<absl::StatusCode>(message.code());
  const auto reason = FindErrorReason(message.reason());
  absl::Status error = reason.has_value() ? MakeError(code, *reason, message.message())
                                          : absl::Status(code, message.message());
  if (message.has_passed_limit() && !error.ok()) {
    const store::v1::PassedLimit& passed = message.passed_limit();
    SetPassedLimit({passed.name(), passed.value(), passed.requested()}, error);
  }
  return error;
}

}  // namespace

std::string EncodeOutcome(const JobOutcome& outcome) {
  store::v1::Outcome message;
  message.set_format(internal::kFormat);
  if (outcome.result != nullptr) Write(*outcome.result, *message.mutable_result());
  if (!outcome.error.ok()) Write(outcome.error, *message.mutable_error());
  if (outcome.phase.has_value()) message.set_phase(MessageOf(kPhases, *outcome.phase));
  if (outcome.last_report.has_value()) Write(*outcome.last_report, *message.mutable_last_report());
  return message.SerializeAsString();
}

absl::StatusOr<JobOutcome> DecodeOutcome(const std::string& bytes) {
  JobOutcome outcome;
  if (bytes.empty()) return outcome;
  store::v1::Outcome message;
  CCST_RETURN_IF_ERROR(internal::ParseStored(bytes, "outcome of a job is", message));
  if (message.has_result()) {
    CCST_ASSIGN_OR_RETURN(outcome.result, Read(message.result()));
  }
  if (message.has_error()) outcome.error = Read(message.error());
  outcome.phase = ValueOf(kPhases, message.phase());
  if (message.has_last_report()) outcome.last_report = Read(message.last_report());
  return outcome;
}

}  // namespace ccst::server
