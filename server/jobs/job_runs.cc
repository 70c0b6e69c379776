#include "server/jobs/job_runs.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include "core/base/status.h"
#include "server/base/deadline.h"
#include "server/base/without_throwing.h"
#include "server/formats/job_history.h"
#include "server/jobs/decoding_threads.h"
#include "server/jobs/job_input.h"
#include "server/jobs/job_records.h"
#include "server/jobs/memory_estimate.h"
#include "server/jobs/run_job.h"
#include "server/jobs/stored_samples.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxPosted = std::size_t{1} << 20;
// Ended jobs whose samples are on their way to the disk, beside those that run.
constexpr int kStorers = 2;
// Between two tries of a job that the store does not take: doubled from the first to the last.
constexpr double kFirstWaitSeconds = 1.0;
constexpr double kLongestWaitSeconds = 64.0;
// A server that others kill or restart over and over should not blame it on what happens to run
// first.
constexpr double kSuspectWaitSeconds = 2.0;
// How often the store is asked whether it takes something again.
constexpr double kLookAgainSeconds = 5.0;

std::string_view StateName(JobState state) {
  switch (state) {
    case JobState::kSucceeded:
      return "succeeded";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
    default:
      return "unfinished";
  }
}

// True where the store lacks what it may have again: space, descriptors, memory. What is damaged or
// gone stays so.
bool MayPass(const absl::Status& store_error) { return absl::IsResourceExhausted(store_error); }

// What the store said of the inputs of a run. A decoder that a stop left behind may still write it.
class LoadError {
 public:
  void Set(const absl::Status& error) {
    MutexLock lock(mutex_);
    error_ = error;
  }
  absl::Status Get() const {
    MutexLock lock(mutex_);
    return error_;
  }

 private:
  mutable Mutex mutex_;
  absl::Status error_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace

JobRuns::JobRuns(Store& store, BlobPins& pins, const JobManagerOptions& options,
                 const JobManagerDependencies& dependencies, LiveJobs& live,
                 std::shared_ptr<MemoryBudget> budget)
    : store_(store),
      pins_(pins),
      options_(options),
      dependencies_(dependencies),
      live_(live),
      budget_(std::move(budget)),
      decoders_(DecodingThreads(options.runner.max_running_jobs), kMaxPosted),
      storers_(kStorers, static_cast<std::size_t>(options.runner.max_running_jobs)) {
  runner_ = std::make_unique<JobRunner>(
      options.runner, budget_,
      [this](const std::shared_ptr<Job>& job, std::shared_ptr<void> grant) {
        Run(job, std::move(grant));
      });
}

absl::StatusOr<std::int64_t> JobRuns::MemoryOf(const JobSpec& spec,
                                               const std::shared_ptr<const HeldInput>& held) const {
  InputCounts input;
  CCST_ASSIGN_OR_RETURN(input, CountInput(store_.blobs(), spec, dependencies_.run, held));
  return EstimateJob(input, spec.options);
}

absl::Status JobRuns::TakeUp(const std::shared_ptr<Job>& job, int starts) {
  const auto memory = MemoryOf(job->spec());
  if (!memory.ok() && !MayPass(memory.status())) return memory.status();
  live_.Add(job);
  if (memory.ok() && starts == 0) {
    // The budget may have become smaller since it was accepted.
    runner_->EnqueueAccepted(job, std::min(*memory, budget_->limit_bytes()));
    return absl::OkStatus();
  }
  if (starts > 0) {
    MutexLock lock(mutex_);
    suspects_.insert(job->id());
  }
  HoldBack(job, starts > 0 ? kSuspectWaitSeconds : kFirstWaitSeconds);
  return absl::OkStatus();
}

void JobRuns::Run(const std::shared_ptr<Job>& job, std::shared_ptr<void> grant) {
  if (const absl::Status begun = Begin(*job); !begun.ok()) {
    grant = nullptr;
    FinishUnlessPutOff(job, begun);
    return;
  }
  const auto load_error = std::make_shared<LoadError>();
  const auto load = [this, load_error, held = job->held_input()](
                        const std::string& sha256) -> absl::StatusOr<std::string> {
    if (held != nullptr && held->sha256 == sha256) return held->bytes;
    auto whole = ReadWhole(store_.blobs(), sha256);
    if (MayPass(whole.status())) load_error->Set(whole.status());
    return whole;
  };
  auto outcome = RunJob(*job, dependencies_.run,
                        {.source = {.load = load, .decoders = decoders_, .grant = grant},
                         .observer = *dependencies_.observer});
  if (const absl::Status error = load_error->Get(); !outcome.ok() && !error.ok()) {
    grant = nullptr;
    FinishUnlessPutOff(job, error);
    return;
  }
  {
    MutexLock lock(mutex_);
    ++storing_;
  }
  auto finish = [this, job, grant = std::move(grant),
                 outcome = std::make_shared<absl::StatusOr<JobResult>>(std::move(outcome))] {
    Finish(job, std::move(*outcome));
    MutexLock lock(mutex_);
    --storing_;
    changed_.notify_all();
  };
  // The worker takes the next job while the disk works.
  if (!storers_.Run(finish)) finish();
}

absl::Status JobRuns::Begin(const Job& job) {
  CCST_RETURN_IF_ERROR(
      store_.blobs().CheckRoom(EstimateStoredBytes(job.spec().options.sample_count)));
  // After a crash it is cancelled, and so needs no count.
  if (job.spec().ends_with_caller) return absl::OkStatus();
  CCST_RETURN_IF_ERROR(store_.CountStart(job.id()));
  {
    MutexLock lock(mutex_);
    started_.insert(job.id());
  }
  if (runner_->draining()) GiveBackStart(job.id());
  return absl::OkStatus();
}

void JobRuns::Finish(const std::shared_ptr<Job>& job, absl::StatusOr<JobResult> outcome) {
  SampleSet samples;
  if (outcome.ok()) samples = std::exchange(outcome->run.samples, {});
  JobView end = job->Seal(std::move(outcome));
  end.expire_time = *end.end_time + options_.retention;
  if (IsPutBack(job->spec(), end)) {
    GiveBackStart(job->id());
    live_.Remove(job->id());
  } else {
    const absl::Status stored =
        WithoutThrowing("storing the result", [&] { return StoreResult(job, samples, end); });
    if (!stored.ok() && end.result != nullptr) {
      samples = {};
      if (!job->spec().ends_with_caller) {
        FinishUnlessPutOff(job, stored);
        return;
      }
      end.state = JobState::kFailed;
      end.error = stored;
      end.result = nullptr;
      end.samples_blob.clear();
      StoreEndAs(job, end).IgnoreError();  // StoreEnds() tries again.
    }
  }
  dependencies_.observer->OnEnd(StateName(end.state),
                                absl::ToDoubleSeconds(*end.end_time - end.create_time));
  job->Publish(std::move(end));
}

absl::Status JobRuns::StoreResult(const std::shared_ptr<Job>& job, const SampleSet& samples,
                                  JobView& end) {
  std::optional<BlobPins::Pin> pin;  // Until the record refers to the blob.
  if (end.result != nullptr) {
    CCST_RETURN_IF_ERROR(StoreHeldInput(*job));
    CCST_ASSIGN_OR_RETURN(end.samples_blob, StoreSamples(samples, pin));
  }
  return StoreEndAs(job, end);
}

absl::Status JobRuns::StoreHeldInput(const Job& job) {
  const auto held = job.held_input();
  // Its record refers to it already, so that nothing else keeps it.
  if (held == nullptr || store_.blobs().Check(held->sha256).ok()) return absl::OkStatus();
  return PutWhole(store_.blobs(), held->bytes).status();
}

absl::StatusOr<std::string> JobRuns::StoreSamples(const SampleSet& samples,
                                                  std::optional<BlobPins::Pin>& pin) {
  std::unique_ptr<BlobWriter> writer;
  CCST_ASSIGN_OR_RETURN(writer, store_.blobs().NewBlob());
  CCST_RETURN_IF_ERROR(WriteSamples(samples, *writer));
  // Before it is in its place, where another job with equal samples may have put it already:
  // deleting that job must not take the blob away before this record refers to it.
  const std::string sha256 = writer->Seal();
  pin.emplace(pins_, sha256);
  CCST_RETURN_IF_ERROR(pins_.Drop(sha256));
  CCST_RETURN_IF_ERROR(writer->Commit());
  return sha256;
}

absl::Status JobRuns::StoreEndAs(const std::shared_ptr<Job>& job, const JobView& end) {
  CCST_RETURN_IF_ERROR(WithoutThrowing("storing the job", [&] {
    return store_.EndJob(EndedRecord(*job, end, options_.retention), EncodeHistory(job->Reports()));
  }));
  live_.SetStored(job);
  MutexLock lock(mutex_);
  started_.erase(job->id());
  suspects_.erase(job->id());
  return absl::OkStatus();
}

absl::Status JobRuns::StoreEnd(const std::shared_ptr<Job>& job) {
  const JobView view = job->View();
  if (!HasEnded(view.state) || IsPutBack(job->spec(), view)) return absl::OkStatus();
  return StoreEndAs(job, view);
}

absl::Status JobRuns::StoreEnds() {
  absl::Status first;
  for (const auto& job : live_.Unstored()) first.Update(StoreEnd(job));
  return first;
}

void JobRuns::EndUnrun(const std::shared_ptr<Job>& job, const absl::Status& error) {
  live_.Add(job);
  Finish(job, error);
}

void JobRuns::FinishUnlessPutOff(const std::shared_ptr<Job>& job, const absl::Status& why) {
  if (job->spec().ends_with_caller) {
    Finish(job, why);
  } else if (const int count = job->PutOff(why); count == 0) {
    Finish(job, StoppedOnRequest());
  } else {
    GiveBackStart(job->id());
    if (count == 1) {
      Report(job->name() + " waits, as the store does not take it now; it runs again by itself: " +
             std::string(why.message()));
    }
    HoldBack(job, std::min(kLongestWaitSeconds, std::exp2(count - 1) * kFirstWaitSeconds));
  }
}

void JobRuns::HoldBack(const std::shared_ptr<Job>& job, double seconds) {
  // All of it where that cannot be told just now.
  const std::int64_t limit = budget_->limit_bytes();
  const std::int64_t memory = std::min(MemoryOf(job->spec()).value_or(limit), limit);
  bool alone = false;
  {
    MutexLock lock(mutex_);
    alone = suspects_.contains(job->id());
  }
  runner_->Hold({.job = job, .memory_bytes = memory, .alone = alone});
  const double ready = dependencies_.run.clock.seconds() + seconds;
  MutexLock lock(mutex_);
  held_[job->id()] = {.job = job, .ready_seconds = ready};
}

void JobRuns::Resume() {
  const double now = dependencies_.run.clock.seconds();
  std::vector<std::shared_ptr<Job>> ready;
  {
    MutexLock lock(mutex_);
    // Others were cancelled, or are left to the next start.
    std::erase_if(held_, [](const auto& entry) {
      return entry.second.job->View().state != JobState::kQueued;
    });
    for (const auto& [id, held] : held_) {
      if (held.ready_seconds <= now) ready.push_back(held.job);
    }
  }
  for (const auto& job : ready) {
    if (StoreTakes(job->spec())) {
      {
        MutexLock lock(mutex_);
        held_.erase(job->id());
      }
      runner_->Release(*job);
    } else {
      MutexLock lock(mutex_);
      held_[job->id()] = {.job = job, .ready_seconds = now + kLookAgainSeconds};
    }
  }
}

bool JobRuns::StoreTakes(const JobSpec& spec) const {
  return store_.blobs().CheckRoom(EstimateStoredBytes(spec.options.sample_count)).ok() &&
         store_.blobs().NewBlob().ok();
}

void JobRuns::StartDraining() {
  runner_->StartDraining();
  std::set<std::string> started;
  {
    MutexLock lock(mutex_);
    started = started_;
  }
  for (const std::string& id : started) GiveBackStart(id);
}

void JobRuns::GiveBackStart(const std::string& id) {
  {
    MutexLock lock(mutex_);
    if (started_.erase(id) == 0) return;
  }
  if (const absl::Status status = store_.GiveBackStart(id); !status.ok()) {
    Report("jobs/" + id +
           " will look as if the server had died while it ran: " + std::string(status.message()));
  }
}

void JobRuns::Report(const std::string& text) const {
  if (dependencies_.report) dependencies_.report(text);
}

bool JobRuns::WaitUntilIdle(absl::Duration timeout) {
  const auto deadline = DeadlineAfter(timeout);
  if (!runner_->WaitUntilIdle(timeout)) return false;
  MutexLock lock(mutex_);
  while (storing_ > 0) {
    if (changed_.wait_until(mutex_, deadline) == std::cv_status::timeout) return storing_ == 0;
  }
  return true;
}

}  // namespace ccst::server
