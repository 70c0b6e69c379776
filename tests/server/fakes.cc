#include "tests/server/fakes.h"

#include <memory>
#include <vector>

#include "core/base/status.h"

namespace ccst::server {

void Gate::Open() {
  {
    const std::lock_guard lock(mutex_);
    open_ = true;
  }
  changed_.notify_all();
}

void Gate::Wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return open_; });
}

bool Gate::WaitOrStop(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  return changed_.wait(lock, stop, [this] { return open_; });
}

SamplingResult MakeResult(std::int64_t count) {
  SamplingResult result;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    result.samples.faces.push_back(i);
    result.samples.barycentrics.emplace_back(0.25, 0.5);
    result.samples.positions.emplace_back(i, 0.0, 1.0);
    result.samples.normals.emplace_back(0.0, 0.0, 1.0);
    result.samples.triangles.emplace_back(i, (i + 1) % count, (i + 2) % count);
  }
  return result;
}

SampleFunction QuickSampler(int alternations) {
  return [alternations](const TriangleMesh&, const SamplingOptions& options,
                        const RunControl& run) -> absl::StatusOr<SamplingResult> {
    SamplingResult result = MakeResult(options.sample_count);
    run.progress->OnPhase(Phase::kRelaxing);
    for (int i = 1; i <= alternations; ++i) {
      AlternationReport report;
      report.alternation = i;
      report.positions = result.samples.positions;
      run.progress->OnAlternation(report);
    }
    result.alternations = alternations;
    return result;
  };
}

SampleFunction GatedSampler(Gate& started, Gate& go) {
  return [&started, &go](const TriangleMesh&, const SamplingOptions& options,
                         const RunControl& run) -> absl::StatusOr<SamplingResult> {
    started.Open();
    if (!go.WaitOrStop(run.stop)) {
      return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped");
    }
    return MakeResult(options.sample_count);
  };
}

RunDependencies FakeDependencies(SampleFunction sample) {
  auto ticks = std::make_shared<std::atomic<int>>(0);
  return {
      .count = [](const ByteSource&, const MeshLimits&) -> absl::StatusOr<MeshCounts> {
        return MeshCounts();
      },
      .image_facts = [](const ByteSource&) -> absl::StatusOr<ImageFacts> { return ImageFacts(); },
      .decode = [](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
        return TriangleMesh();
      },
      .decode_image = [](std::span<const char>) -> absl::StatusOr<Image> { return Image(); },
      .sample = std::move(sample),
      .digest = [](const SampleSet&) { return std::string("digest"); },
      .clock = {.now = [] { return absl::FromUnixSeconds(1'700'000'000); },
                .seconds = [ticks] { return static_cast<double>(++*ticks); }},
      .mesh_limits = {},
      .threads_per_job = 1};
}

Job::Post PostNow() {
  return [](const std::function<void()>& task, Urgency /*urgency*/) {
    if (task != nullptr) task();
  };
}

RunInputs FakeInputs(Executor& decoders, JobObserver& observer) {
  return {
      .source = {.load = [](const std::string&) -> absl::StatusOr<std::string> { return "mesh"; },
                 .decoders = decoders,
                 .grant = nullptr},
      .observer = observer};
}

std::function<std::string()> CountingIds() {
  auto last = std::make_shared<std::atomic<int>>(0);
  return [last] { return std::to_string(++*last); };
}

}  // namespace ccst::server
