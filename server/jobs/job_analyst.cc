#include "server/jobs/job_analyst.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/repair/repair.h"
#include "core/sampling/density_source.h"
#include "core/sampling/source_map.h"
#include "server/jobs/job_input.h"
#include "server/jobs/stored_samples.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxPosted = std::size_t{1} << 20;

using analysis::ReferenceSurface;

absl::StatusOr<ReferenceSurface> MakeReference(const TriangleMesh& mesh, double weld_tolerance,
                                               const DensityOptions& density,
                                               Interrupt& interrupt) {
  RepairedMesh repaired;
  CCST_ASSIGN_OR_RETURN(repaired, Repair(mesh, {.weld_tolerance = weld_tolerance}, &interrupt));
  CCST_ASSIGN_OR_RETURN(Surface surface, Surface::Build(repaired.mesh, &interrupt));
  CCST_ASSIGN_OR_RETURN(Density made,
                        MakeDensity(mesh, SourceMap(mesh, repaired), surface, density));
  return ReferenceSurface(std::move(surface), std::move(made));
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
  auto counts = CountMesh(blobs_, job.spec().mesh_sha256, run_);
  if (HasNoSurface(counts.status())) {
    counts = MeshCounts{.vertices = stored.sample_count(), .faces = stored.triangle_count()};
  }
  if (!counts.ok()) return counts.status();
  SamplingOptions options;
  options.sample_count = stored.sample_count();
  // The budget may have become smaller since the job was accepted.
  const std::int64_t wanted =
      std::min(EstimateMemory(counts->vertices, counts->faces, options), budget_->limit_bytes());
  auto grant = budget_->TakeWithin(longest_wait_, wanted, stop);
  if (grant != nullptr) return grant;
  if (stop.stop_requested()) return StoppedOnRequest();
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                   "jobs use the memory that measuring needs, " + std::to_string(wanted) +
                       " bytes; ask again later");
}

absl::StatusOr<std::optional<ReferenceSurface>> JobAnalyst::SurfaceOf(
    const JobSpec& spec, const SampleSet& samples, const std::shared_ptr<void>& grant,
    const std::stop_token& stop) {
  Interrupt interrupt(stop);
  DensityOptions density = spec.options.density;
  auto input =
      LoadInput(spec, run_,
                {.load = [this](const std::string& sha256) { return ReadWhole(blobs_, sha256); },
                 .decoders = decoders_,
                 .grant = grant},
                stop);
  absl::Status failed = input.status();
  if (input.ok()) {
    density.image = std::move(input->image);
    auto sampled = MakeReference(input->mesh, spec.options.weld_tolerance, density, interrupt);
    if (sampled.ok()) return sampled;
    failed = sampled.status();
  }
  if (!HasNoSurface(failed)) return failed;
  if (samples.triangles.empty() || density.source != DensitySource::kUniform) return std::nullopt;
  auto own = MakeReference({samples.positions, samples.triangles}, 0.0, density, interrupt);
  if (HasNoSurface(own.status())) return std::nullopt;
  return own;
}

absl::StatusOr<JobFigures> JobAnalyst::Measure(const Job& job, const std::stop_token& stop) {
  if (stop.stop_requested()) return StoppedOnRequest();
  auto stored = jobs_.OpenSamples(job);
  if (!stored.ok()) return stored.status();
  std::shared_ptr<void> grant;
  CCST_ASSIGN_OR_RETURN(grant, TakeMemory(job, *stored, stop));
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples, stored->ReadSamples(0, stored->sample_count()));
  SampleSet mesh;
  CCST_ASSIGN_OR_RETURN(mesh, stored->ReadTriangles(0, stored->triangle_count()));
  samples.triangles = std::move(mesh.triangles);

  const SamplingResult& run = job.View().result->run;
  JobFigures figures;
  figures.distances =
      quality::MeasureDistances(samples.positions, samples.normals, run.surface.area);
  if (!samples.triangles.empty()) {
    figures.mesh = JobFigures::Mesh{
        .capacity_cv = run.capacity_cv,
        .angles = quality::MeasureAngles(samples.positions, samples.triangles),
        .valences = quality::MeasureValences(stored->sample_count(), samples.triangles)};
  }
  const auto surface = SurfaceOf(job.spec(), samples, grant, stop);
  if (stop.stop_requested()) return StoppedOnRequest();
  if (!surface.ok()) return surface.status();
  if (!surface->has_value()) return figures;
  Interrupt interrupt(stop);
  const analysis::SampleSetView set = {samples.positions, samples.triangles};
  figures.on_surface = analysis::MeasureSamples(**surface, {&set, 1}, {.surface_distance = false},
                                                Parallel(), &interrupt);
  if (interrupt.Requested()) return StoppedOnRequest();
  return figures;
}

}  // namespace ccst::server
