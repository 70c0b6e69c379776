#pragma once

#include <memory>
#include <optional>
#include <stop_token>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "core/analysis/sample_figures.h"
#include "core/base/interrupt.h"
#include "core/quality/distances.h"
#include "core/quality/sample_mesh_quality.h"
#include "server/base/executor.h"
#include "server/jobs/job_manager.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/run_dependencies.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// What the samples of a job are worth.
struct JobFigures {
  quality::DistanceFigures distances;  ///< Over the hexagonal spacing, whatever the density.

  /// Of the sample mesh.
  struct Mesh {
    double capacity_cv = 0.0;  ///< As the run counted it.
    quality::AngleFigures angles;
    quality::ValenceFigures valences;
  };
  std::optional<Mesh> mesh;

  /// On the mesh that was sampled, with the density that was asked for: jobs on one mesh are judged
  /// alike, whatever made their samples. Where that mesh is gone, on the sample mesh, which lies
  /// near it; empty where there is none, or a density that only the lost mesh would tell.
  std::optional<analysis::SampleFigures> on_surface;
};

/// Measures what ended jobs left. Takes the memory for it from the budget of jobs, see
/// EstimateAnalysis(). Computes on the calling thread, decodes on threads of its own. Equal samples
/// give equal bits. Thread-safe.
class JobAnalyst {
 public:
  /// `jobs` and `blobs` outlive it.
  /// @param threads  that may call Measure() at once.
  /// @param longest_wait  for memory that jobs hold.
  JobAnalyst(const JobManager& jobs, const BlobStore& blobs, std::shared_ptr<MemoryBudget> budget,
             RunDependencies run, int threads, absl::Duration longest_wait);

  /// Measures the samples of `job`. Cost as analysis::MeasureSamples(), and Repair() of the mesh. A
  /// stop, and the end of the time that the dependencies allow, are answered within 200 ms for up
  /// to some million samples and faces.
  /// @errors as JobManager::OpenSamples() | CANCELLED `stop` was requested
  ///       | INVALID_ARGUMENT LIMIT_EXCEEDED it needs more memory than the budget
  ///       | DEADLINE_EXCEEDED TIME_LIMIT_EXCEEDED it took longer than any computation may
  ///       | RESOURCE_EXHAUSTED QUEUE_FULL jobs hold the memory for too long, OUT_OF_MEMORY
  absl::StatusOr<JobFigures> Measure(const Job& job, const std::stop_token& stop);

 private:
  absl::StatusOr<std::shared_ptr<void>> TakeMemory(const Job& job, const StoredSamples& stored,
                                                   const std::stop_token& stop) const;
  absl::StatusOr<std::optional<analysis::ReferenceSurface>> SurfaceOf(
      const JobSpec& spec, const SampleSet& samples, const std::shared_ptr<void>& grant,
      const std::stop_token& stop, std::optional<Interrupt::Clock::time_point> deadline);

  const JobManager& jobs_;
  const BlobStore& blobs_;
  const std::shared_ptr<MemoryBudget> budget_;
  const RunDependencies run_;
  const absl::Duration longest_wait_;
  Executor decoders_;
};

}  // namespace ccst::server
