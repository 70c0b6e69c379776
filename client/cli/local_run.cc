#include "client/cli/local_run.h"

#include <chrono>
#include <utility>

#include "core/base/status.h"
#include "core/io/samples_digest.h"

namespace ccst::cli {
namespace {

class Listener : public ProgressSink {
 public:
  explicit Listener(const std::function<void(const AlternationReport&)>& on_progress)
      : on_progress_(on_progress) {}

  void OnPhase(Phase) override {}
  void OnAlternation(const AlternationReport& report) override { on_progress_(report); }

 private:
  const std::function<void(const AlternationReport&)>& on_progress_;
};

}  // namespace

absl::StatusOr<SampleOutcome> SampleLocally(
    const MeshInput& input, const SamplingOptions& options,
    const std::function<void(const AlternationReport&)>& on_progress, const std::stop_token& stop,
    StageSink* stages) {
  const auto start = std::chrono::steady_clock::now();
  Listener listener(on_progress);
  SampleOutcome outcome;
  CCST_ASSIGN_OR_RETURN(
      outcome.result,
      SampleSurface(input.wire, options, {.stop = stop, .progress = &listener, .stages = stages}));
  if (outcome.result.termination == Termination::kStopped) {
    return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "cancelled");
  }
  outcome.record.samples_sha256 = SamplesDigest(outcome.result.samples);
  CCST_RETURN_IF_ERROR(PlaceSamples(input.wire, input.origin, outcome.result.samples));
  outcome.record.total_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

}  // namespace ccst::cli
