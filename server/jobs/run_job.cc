#include "server/jobs/run_job.h"

#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

class JobProgress : public ProgressSink {
 public:
  explicit JobProgress(Job& job) : job_(job) {}
  void OnPhase(Phase phase) override { job_.AddPhase(phase); }
  void OnAlternation(const AlternationReport& report) override { job_.AddReport(report); }

 private:
  Job& job_;
};

std::vector<std::string> WarningsOf(const SamplingResult& result) {
  std::vector<std::string> warnings;
  const SurfaceSummary& surface = result.surface;
  if (surface.closed_loops > 0) {
    warnings.push_back(std::to_string(surface.closed_loops) +
                       " boundary loops are too short for the sample spacing and are closed in "
                       "the sample mesh");
  }
  if (surface.untriangulated_components > 0) {
    warnings.push_back(
        std::to_string(surface.untriangulated_components) + " of " +
        std::to_string(surface.components) +
        " components are too small for a triangulation at this sample_count; their " +
        std::to_string(surface.untriangulated_samples) +
        " samples are spread by capacity and belong to no sample triangle");
  }
  if (result.termination == Termination::kTimeLimit) {
    warnings.push_back("the time limit ended the run after " + std::to_string(result.alternations) +
                       " alternations; the samples depend on the machine");
  }
  return warnings;
}

// Length of the byte layout of proto/docs/samples.md, which the digest is of: a mark of 15 bytes,
// two counts, 20 bytes a sample and 12 a triangle.
std::int64_t LayoutBytes(const SampleSet& samples) {
  return 15 + 2 * 8 + 20 * static_cast<std::int64_t>(samples.faces.size()) +
         12 * static_cast<std::int64_t>(samples.triangles.size());
}

absl::StatusOr<JobResult> Compute(Job& job, const RunDependencies& dependencies) {
  const auto seconds = dependencies.clock.seconds;
  const double start = seconds();
  const absl::Status stopped =
      MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped on request");
  if (job.stop_token().stop_requested()) return stopped;
  TriangleMesh mesh;
  {
    const std::string bytes = job.TakeMesh();
    CCST_ASSIGN_OR_RETURN(mesh, dependencies.decode(bytes, dependencies.mesh_limits));
  }
  SamplingOptions options = job.options();
  if (options.density.encoded_image != nullptr) {
    CCST_ASSIGN_OR_RETURN(Image image, dependencies.decode_image(*options.density.encoded_image));
    options.density.image = std::make_shared<const Image>(std::move(image));
  }
  if (job.stop_token().stop_requested()) return stopped;
  JobResult result;
  result.queue_seconds = job.queue_seconds();
  result.decode_seconds = seconds() - start;
  JobProgress progress(job);
  CCST_ASSIGN_OR_RETURN(
      result.run,
      dependencies.sample(mesh, options, {.stop = job.stop_token(), .progress = &progress}));
  if (result.run.termination == Termination::kStopped) return stopped;
  result.samples_sha256 = dependencies.digest(result.run.samples);
  result.samples_bytes = LayoutBytes(result.run.samples);
  result.warnings = WarningsOf(result.run);
  result.total_seconds = seconds() - start;
  return result;
}

absl::StatusOr<JobResult> ComputeWithoutThrowing(Job& job, const RunDependencies& dependencies) {
  try {
    return Compute(job, dependencies);
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                     "the computation needs more memory than there is; ask for fewer samples or "
                     "send a smaller mesh");
  } catch (const std::exception& e) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                     std::string("the computation broke: ") + e.what());
  } catch (...) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal, "the computation broke");
  }
}

}  // namespace

void RunJob(Job& job, const RunDependencies& dependencies) {
  job.End(ComputeWithoutThrowing(job, dependencies));
}

}  // namespace ccst::server
