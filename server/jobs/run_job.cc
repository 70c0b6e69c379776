#include "server/jobs/run_job.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "server/base/without_throwing.h"

namespace ccst::server {
namespace {

constexpr double kLeastLimit = 1e-9;  // [s]

// Keeps what happens in the job and tells the observer how long each phase took.
class JobProgress : public ProgressSink {
 public:
  JobProgress(Job& job, JobObserver& observer, const Clock& clock)
      : job_(job), observer_(observer), clock_(clock), since_(clock.seconds()) {}

  void OnPhase(Phase phase) override {
    EndPhase();
    phase_ = phase;
    job_.AddPhase(phase);
  }

  void OnAlternation(const AlternationReport& report) override {
    job_.AddReport(report);
    observer_.OnAlternation();
  }

  void EndPhase() {
    const double now = clock_.seconds();
    if (phase_.has_value()) observer_.OnPhase(PhaseName(*phase_), now - since_);
    since_ = now;
  }

 private:
  static std::string_view PhaseName(Phase phase) {
    switch (phase) {
      case Phase::kPreparing:
        return "preparing";
      case Phase::kInitializing:
        return "initializing";
      case Phase::kRelaxing:
        return "relaxing";
      case Phase::kFinalizing:
        return "finalizing";
    }
    return "unknown";
  }

  Job& job_;
  JobObserver& observer_;
  const Clock& clock_;
  std::optional<Phase> phase_;
  double since_;
};

// The time limit counts from here, over all that is done for the job.
std::optional<Interrupt::Clock::time_point> DeadlineOf(const SamplingOptions& options) {
  if (!options.time_limit_seconds.has_value()) return std::nullopt;
  return Interrupt::DeadlineAfter(Interrupt::Clock::now(), *options.time_limit_seconds);
}

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

absl::StatusOr<JobResult> Compute(Job& job, const RunDependencies& dependencies,
                                  const RunInputs& inputs) {
  const auto seconds = dependencies.clock.seconds;
  const double start = seconds();
  if (job.stop_token().stop_requested()) return StoppedOnRequest();
  const JobSpec& spec = job.spec();
  JobInput input;
  const auto deadline = DeadlineOf(spec.options);
  CCST_ASSIGN_OR_RETURN(input,
                        LoadInput(spec, dependencies, inputs.source, job.stop_token(), deadline));
  SamplingOptions options = spec.options;
  if (deadline.has_value()) {
    // What decoding took is gone. Never 0, which is no limit: the run says that it has no time.
    const std::chrono::duration<double> left = *deadline - Interrupt::Clock::now();
    options.time_limit_seconds = std::max(left.count(), kLeastLimit);
  }
  options.thread_count = dependencies.threads_per_job;
  options.density.image = std::move(input.image);
  JobResult result;
  result.queue_seconds = job.QueueSeconds();
  result.decode_seconds = seconds() - start;
  inputs.observer.OnPhase("decoding", result.decode_seconds);
  JobProgress progress(job, inputs.observer, dependencies.clock);
  CCST_ASSIGN_OR_RETURN(
      result.run,
      dependencies.sample(input.mesh, options, {.stop = job.stop_token(), .progress = &progress}));
  progress.EndPhase();
  if (result.run.termination == Termination::kStopped) return StoppedOnRequest();
  const SampleSet& samples = result.run.samples;
  result.sample_count = static_cast<std::int64_t>(samples.faces.size());
  result.triangle_count = static_cast<std::int64_t>(samples.triangles.size());
  result.samples_sha256 = dependencies.digest(samples);
  result.samples_bytes = LayoutBytes(samples);
  result.warnings = WarningsOf(result.run);
  result.total_seconds = seconds() - start;
  return result;
}

}  // namespace

absl::StatusOr<JobResult> RunJob(Job& job, const RunDependencies& dependencies,
                                 const RunInputs& inputs) {
  return WithoutThrowing("the computation", [&] { return Compute(job, dependencies, inputs); });
}

}  // namespace ccst::server
