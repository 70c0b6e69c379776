#include "server/jobs/job_analyst.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "core/base/interrupt.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "core/sampling/input/prepared_surface.h"
#include "server/jobs/job_input.h"
#include "server/jobs/memory_estimate.h"
#include "server/jobs/stored_samples.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxPosted = std::size_t{1} << 20;

using analysis::ReferenceSurface;

absl::StatusOr<ReferenceSurface> MakeReference(const TriangleMesh& mesh,
                                               const SamplingOptions& options,
                                               Interrupt& interrupt) {
  CCST_ASSIGN_OR_RETURN(
      internal::PreparedSurface prepared,
      internal::Prepare(mesh, options, internal::Purpose::kMeasuring, &interrupt));
  return ReferenceSurface(std::move(prepared.surface), std::move(prepared.density), &interrupt);
}

// There is no surface to measure on: what it would be made of is gone, over limits that were higher
// once, or no surface, as samples that all lie on a line. What is damaged, stopped or short of
// memory is another matter.
bool HasNoSurface(const absl::Status& status) {
  return absl::IsNotFound(status) || absl::IsFailedPrecondition(status) ||
         absl::IsInvalidArgument(status);
}

}  // namespace

JobAnalyst::JobAnalyst(const JobManager& jobs, const BlobStore& blobs,
                       std::shared_ptr<MemoryBudget> budget, RunDependencies run, int threads,
                       absl::Duration longest_wait)
    : jobs_(jobs),
      blobs_(blobs),
      budget_(std::move(budget)),
      run_(std::move(run)),
      longest_wait_(longest_wait),
      decoders_(threads, kMaxPosted) {}

absl::StatusOr<std::shared_ptr<void>> JobAnalyst::TakeMemory(const Job& job,
                                                             const StoredSamples& stored,
                                                             const std::stop_token& stop) const {
  auto input = CountInput(blobs_, job.spec(), run_);
  if (HasNoSurface(input.status())) {
    // The sample mesh stands in.
    const std::int64_t vertices = stored.sample_count();
    const std::int64_t faces = stored.triangle_count();
    input = InputCounts{.mesh = {.vertices = vertices,
                                 .faces = faces,
                                 .mesh_bytes = std::int64_t{sizeof(Eigen::Vector3d)} * vertices +
                                               std::int64_t{sizeof(Eigen::Vector3i)} * faces}};
  }
  if (!input.ok()) return input.status();
  const std::int64_t wanted =
      EstimateAnalysis(*input, job.spec().options.density, stored.sample_count());
  if (wanted > budget_->limit_bytes()) {
    return OverLimit({"max_job_memory_bytes", budget_->limit_bytes(), wanted},
                     "measuring the samples may need " + std::to_string(wanted) +
                         " bytes of memory, over max_job_memory_bytes, " +
                         std::to_string(budget_->limit_bytes()));
  }
  auto grant = budget_->TakeWithin(longest_wait_, wanted, stop);
  if (grant != nullptr) return grant;
  if (stop.stop_requested()) return StoppedOnRequest();
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                   "jobs use the memory that measuring needs, " + std::to_string(wanted) +
                       " bytes; ask again later");
}

absl::StatusOr<std::optional<ReferenceSurface>> JobAnalyst::SurfaceOf(
    const JobSpec& spec, const SampleSet& samples, const std::shared_ptr<void>& grant,
    const std::stop_token& stop, std::optional<Interrupt::Clock::time_point> deadline) {
  Interrupt interrupt(stop, deadline);
  SamplingOptions options = spec.options;
  auto input =
      LoadInput(spec, run_,
                {.load = [this](const std::string& sha256) { return ReadWhole(blobs_, sha256); },
                 .decoders = decoders_,
                 .grant = grant},
                stop, deadline);
  absl::Status failed = input.status();
  if (input.ok()) {
    options.density.image = std::move(input->image);
    auto sampled = MakeReference(input->mesh, options, interrupt);
    if (sampled.ok()) return sampled;
    failed = sampled.status();
  }
  if (!HasNoSurface(failed)) return failed;
  if (samples.triangles.empty() || options.density.source != DensitySource::kUniform) {
    return std::nullopt;
  }
  auto own = MakeReference({samples.positions, samples.triangles}, SamplingOptions(), interrupt);
  if (HasNoSurface(own.status())) return std::nullopt;
  return own;
}

absl::StatusOr<JobFigures> JobAnalyst::Measure(const Job& job, const std::stop_token& stop) {
  if (stop.stop_requested()) return StoppedOnRequest();
  auto stored = jobs_.OpenSamples(job);
  if (!stored.ok()) return stored.status();
  std::shared_ptr<void> grant;
  CCST_ASSIGN_OR_RETURN(grant, TakeMemory(job, *stored, stop));
  const auto deadline = Interrupt::DeadlineAfter(Interrupt::Clock::now(), run_.max_seconds);
  Interrupt interrupt(stop, deadline);
  const auto ended = [&] {
    return interrupt.cause() == Interrupt::Cause::kTimeLimit
               ? interrupt.Error("samples were measured")
               : StoppedOnRequest();
  };
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples, stored->ReadSamples(0, stored->sample_count()));
  SampleSet mesh;
  CCST_ASSIGN_OR_RETURN(mesh, stored->ReadTriangles(0, stored->triangle_count()));
  samples.triangles = std::move(mesh.triangles);

  const SamplingResult& run = job.View().result->run;
  JobFigures figures;
  figures.distances =
      quality::MeasureDistances(samples.positions, samples.normals, run.surface.area,
                                Eigen::Vector3d::Zero(), {}, Parallel(), &interrupt);
  if (interrupt.Requested()) return ended();
  if (!samples.triangles.empty()) {
    figures.mesh = JobFigures::Mesh{
        .capacity_cv = run.capacity_cv,
        .angles = quality::MeasureAngles(samples.positions, samples.triangles),
        .valences = quality::MeasureValences(stored->sample_count(), samples.triangles)};
  }
  const auto surface = SurfaceOf(job.spec(), samples, grant, stop, deadline);
  if (interrupt.Requested()) return ended();
  if (!surface.ok()) return surface.status();
  if (!surface->has_value()) return figures;
  const analysis::SampleSetView set = {samples.positions, samples.triangles};
  figures.on_surface = analysis::MeasureSamples(**surface, {&set, 1}, {.surface_distance = false},
                                                Parallel(), &interrupt);
  if (interrupt.Requested()) return ended();
  return figures;
}

}  // namespace ccst::server
