#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "server/jobs/job_manager.h"
#include "tests/server/fakes.h"
#include "tests/server/temp_folder.h"
#include "tests/server/watched_store.h"

namespace ccst::server {

/// Counts what it is told, on the thread that tells.
class CountingJobObserver final : public JobObserver {
 public:
  void OnPhase(std::string_view /*phase*/, double /*seconds*/) override {}
  void OnAlternation() override {}
  void OnEnd(std::string_view /*state*/, double /*seconds*/) override {}
  void OnCancel(std::string_view reason) override { ++cancels[std::string(reason)]; }
  void OnCacheLookup(std::string_view /*cache*/, bool hit) override { ++(hit ? hits : misses); }

  // Told on the thread that asks.
  std::map<std::string, int> cancels;
  int hits = 0;
  int misses = 0;
};

/// For WatchedStore::before: nothing fails.
inline absl::Status AllIsWell(std::string_view /*call*/) { return absl::OkStatus(); }

/// For WatchedStore::before: `call` fails with `error`.
inline auto Failing(std::string_view call, absl::Status error) {
  return [call, error = std::move(error)](std::string_view called) {
    return called == call ? error : absl::OkStatus();
  };
}

/// The error of a full disk.
inline absl::Status FullDisk() {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kStorageFull, "full");
}

/// A manager over a real store, which can be started anew and made to fail.
class JobManagerTest : public testing::Test {
 protected:
  // Opens the store anew, as another process would, with `sample` as the sampler.
  void Start(SampleFunction sample, JobManagerOptions options = {}) {
    Stop();
    store_ =
        std::make_unique<WatchedStore>(*OpenEmbeddedStore(folder_.Path("data"), max_blob_bytes_));
    store_->before = before_start_;
    pins_ = std::make_unique<BlobPins>(*store_);
    RunDependencies run = FakeDependencies(std::move(sample));
    run.clock.now = [this] { return now_; };
    run.count = [](const ByteSource&, const MeshLimits&) -> absl::StatusOr<MeshCounts> {
      return MeshCounts{.vertices = 10, .faces = 20};
    };
    jobs_ = *JobManager::Start(*store_, *pins_, options,
                               {.run = std::move(run),
                                .new_id = ids_,
                                .observer = &observer_,
                                .budget = budget_,
                                .report = [this](const std::string& line) { Keep(line); }});
  }
  // Stops as a process does that is killed: nothing more is written down.
  void Die() {
    store_->before = [](std::string_view call) {
      return call == "GiveBackStart" || call == "EndJob" ? absl::InternalError("killed")
                                                         : absl::OkStatus();
    };
    Stop();
  }
  // Sweeps, which a clock that goes on with every look makes a matter of time, until `id` is in
  // `state`.
  JobView SweepUntil(const std::string& id, JobState state) {
    JobView view;
    for (int i = 0; i < 1000; ++i) {
      jobs_->Sweep().IgnoreError();
      jobs_->WaitUntilIdle(absl::InfiniteDuration());
      view = (*jobs_->Find("", id))->View();
      if (view.state == state) break;
    }
    EXPECT_EQ(view.state, state);
    return view;
  }
  void Keep(const std::string& line) {
    const std::lock_guard lock(lines_mutex_);
    lines_ += line + "\n";
  }
  std::string lines() {
    const std::lock_guard lock(lines_mutex_);
    return lines_;
  }
  void Stop() {
    jobs_ = nullptr;
    pins_ = nullptr;
    store_ = nullptr;
  }
  void TearDown() override { Stop(); }

  JobSpec Spec(std::uint64_t seed = 0) {
    JobSpec spec;
    spec.share = "caller";
    spec.mesh_sha256 = *PutWhole(store_->blobs(), "mesh");
    spec.options.sample_count = 10;
    spec.options.seed = seed;
    return spec;
  }
  std::shared_ptr<Job> Create(JobSpec spec) {
    auto job = jobs_->Create(spec);
    EXPECT_TRUE(job.ok()) << job.status();
    return *std::move(job);
  }
  JobView Finish(const std::string& id) {
    jobs_->WaitUntilIdle(absl::InfiniteDuration());
    return (*jobs_->Find("", id))->View();
  }

  std::int64_t max_blob_bytes_ = std::numeric_limits<std::int64_t>::max();
  std::function<absl::Status(std::string_view)> before_start_ = AllIsWell;
  std::mutex lines_mutex_;
  std::string lines_;
  Gate started_;
  Gate never_;
  TempFolder folder_;
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::function<std::string()> ids_ = CountingIds();
  CountingJobObserver observer_;
  std::shared_ptr<MemoryBudget> budget_;  // Null: the manager's own.
  std::unique_ptr<WatchedStore> store_;
  std::unique_ptr<BlobPins> pins_;
  std::unique_ptr<JobManager> jobs_;
};

}  // namespace ccst::server
