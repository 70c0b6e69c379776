#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "server/jobs/run_job.h"

namespace ccst::server {

/// Something threads wait for.
class Gate {
 public:
  void Open();
  void Wait();
  /// False when `stop` came first.
  bool WaitOrStop(std::stop_token stop);

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool open_ = false;
};

using SampleFunction = decltype(RunDependencies::sample);

/// A whole result with `count` samples and as many triangles; sample i lies on face i.
SamplingResult MakeResult(std::int64_t count);

/// Reports `alternations` at once and returns MakeResult(options.sample_count).
SampleFunction QuickSampler(int alternations = 1);

/// Opens `started`, then waits for `go`; stops when asked to, as the core does before its first
/// iterate.
SampleFunction GatedSampler(Gate& started, Gate& go);

/// Any bytes decode to an empty mesh; time stands still but for one second a call; the digest is
/// `digest`.
RunDependencies FakeDependencies(SampleFunction sample);

/// Carries news to watchers at once.
Job::Post PostNow();

/// Any digest loads as `mesh`.
RunInputs FakeInputs(Executor& decoders, JobObserver& observer);

/// Ids `1`, `2`, ...
std::function<std::string()> CountingIds();

}  // namespace ccst::server
