#include "server/jobs/job_manager.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxPosted = std::size_t{1} << 20;
// Ended jobs whose samples are on their way to the disk, beside those that run.
constexpr int kStorers = 2;
constexpr int kSweepBatch = 100;
// What a sample and its two triangles take on the disk, about.
constexpr std::int64_t kStoredBytesPerSample = 100;

absl::Status NotFound(const std::string& id) {
  return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                   "there is no job jobs/" + id + ", or not any more");
}

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

std::string_view CauseName(StopCause cause) {
  switch (cause) {
    case StopCause::kCaller:
      return "caller";
    case StopCause::kDrain:
      return "drain";
    case StopCause::kAbandoned:
      return "abandoned";
    case StopCause::kNone:
      break;
  }
  return "none";
}

}  // namespace

JobManager::JobManager(Store& store, BlobPins& pins, const JobManagerOptions& options,
                       JobManagerDependencies dependencies)
    : store_(store),
      pins_(pins),
      options_(options),
      dependencies_(std::move(dependencies)),
      records_(dependencies_.codec),
      budget_(dependencies_.budget != nullptr
                  ? dependencies_.budget
                  : std::make_shared<MemoryBudget>(options.memory_budget_bytes)),
      notifier_(1, kMaxPosted),
      decoders_(2 * options.runner.max_running_jobs, kMaxPosted),
      storers_(kStorers, static_cast<std::size_t>(options.runner.max_running_jobs)) {
  runner_ = std::make_unique<JobRunner>(
      options_.runner, budget_,
      [this](const std::shared_ptr<Job>& job, std::shared_ptr<void> grant) {
        Run(job, std::move(grant));
      });
}

JobManager::~JobManager() { runner_ = nullptr; }

absl::StatusOr<std::unique_ptr<JobManager>> JobManager::Start(Store& store, BlobPins& pins,
                                                              const JobManagerOptions& options,
                                                              JobManagerDependencies dependencies) {
  std::unique_ptr<JobManager> manager(
      new JobManager(store, pins, options, std::move(dependencies)));
  std::vector<JobRecord> unfinished;
  CCST_ASSIGN_OR_RETURN(unfinished, store.UnfinishedJobs());
  for (const JobRecord& record : unfinished) CCST_RETURN_IF_ERROR(manager->TakeUp(record));
  return manager;
}

absl::Status JobManager::TakeUp(const JobRecord& record) {
  auto spec = records_.SpecOf(record);
  if (!spec.ok()) {
    const absl::Time now = dependencies_.run.clock.now();  // Others shall run nevertheless.
    return store_.EndJob(records_.Failed(record, spec.status(), now, options_.retention), "");
  }
  const bool cancelled = record.state == JobState::kCancelling || spec->ends_with_caller;
  const std::shared_ptr<Job> job = NewJob(record.id, *std::move(spec));
  if (cancelled) {
    job->Cancel(StopCause::kCaller);
    return StoreEnd(*job, job->View());
  }
  const auto memory = MemoryOf(job->spec());
  if (!memory.ok()) {
    job->Take();
    return StoreEnd(*job, job->Seal(memory.status()));
  }
  {
    MutexLock lock(mutex_);
    live_[job->id()] = job;
  }
  // The budget may have become smaller since it was accepted.
  runner_->EnqueueAccepted(job, std::min(*memory, budget_->limit_bytes()));
  return absl::OkStatus();
}

std::shared_ptr<Job> JobManager::NewJob(std::string id, JobSpec spec) {
  // Not make_shared: a weak pointer of ended_ would keep the job's own memory until the next sweep.
  return std::make_unique<Job>(
      std::move(id), std::move(spec), dependencies_.run.clock,
      [this](std::function<void()> task) { notifier_.Run(std::move(task)); });
}

absl::StatusOr<std::int64_t> JobManager::MemoryOf(const JobSpec& spec) const {
  MeshCounts counts;
  CCST_ASSIGN_OR_RETURN(counts, CountMesh(store_.blobs(), spec.mesh_sha256, dependencies_.run));
  return EstimateMemory(counts.vertices, counts.faces, spec.options);
}

absl::Status JobManager::Check(const JobSpec& spec) const { return AdmittedMemory(spec).status(); }

absl::StatusOr<std::int64_t> JobManager::AdmittedMemory(const JobSpec& spec) const {
  std::int64_t memory = 0;
  CCST_ASSIGN_OR_RETURN(memory, MemoryOf(spec));
  if (memory <= budget_->limit_bytes()) return memory;
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kLimitExceeded,
                   "the job may need " + std::to_string(memory) +
                       " bytes of memory, over max_job_memory_bytes, " +
                       std::to_string(budget_->limit_bytes()) +
                       "; ask for fewer samples or send a smaller mesh");
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Create(JobSpec spec) {
  if (!spec.request_id.empty()) {
    std::optional<JobRecord> earlier;
    CCST_ASSIGN_OR_RETURN(earlier, store_.FindRequest(spec.owner, spec.request_id));
    if (earlier.has_value()) return Find(spec.owner, earlier->id);
  }
  std::int64_t memory = 0;
  CCST_ASSIGN_OR_RETURN(memory, AdmittedMemory(spec));
  CCST_RETURN_IF_ERROR(store_.blobs().CheckRoom(kStoredBytesPerSample * spec.options.sample_count));
  auto place = runner_->Reserve(spec.share);
  if (!place.ok()) return place.status();
  const JobRecord record =
      records_.New(dependencies_.new_id(), spec, dependencies_.run.clock.now());
  if (!spec.skip_cache_lookup) {
    std::shared_ptr<Job> answered;
    CCST_ASSIGN_OR_RETURN(answered, AnswerFromCache(record, spec));
    dependencies_.observer->OnCacheLookup("result", answered != nullptr);
    if (answered != nullptr) return answered;
  }
  const std::shared_ptr<Job> job = NewJob(record.id, std::move(spec));
  {
    // Found from the moment on that it is stored.
    MutexLock lock(mutex_);
    live_[job->id()] = job;
  }
  auto stored = store_.AddJob(record);
  if (!stored.ok() || stored->id != record.id) {
    MutexLock lock(mutex_);
    live_.erase(job->id());
  }
  if (!stored.ok()) return stored.status();
  if (stored->id != record.id) return Find(stored->owner, stored->id);
  runner_->Enqueue(*std::move(place), job, memory);
  return job;
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::AnswerFromCache(const JobRecord& record,
                                                                 const JobSpec& spec) {
  const absl::Time now = dependencies_.run.clock.now();
  std::optional<JobRecord> found;
  CCST_ASSIGN_OR_RETURN(found, store_.FindReusable(record.spec_digest, now));
  if (!found.has_value()) return nullptr;
  const BlobPins::Pin pin(pins_, found->samples_sha256);
  if (!store_.blobs().Contains(found->samples_sha256)) return nullptr;
  std::string history;
  CCST_ASSIGN_OR_RETURN(history, store_.GetHistory(found->id));
  JobRecord added;
  CCST_ASSIGN_OR_RETURN(added, store_.AddJob(record));
  if (added.id != record.id) return Find(spec.owner, added.id);
  JobRecord ended = record;
  ended.state = JobState::kSucceeded;
  ended.start_time = now;
  ended.end_time = now;
  ended.expire_time = now + options_.retention;
  ended.outcome = found->outcome;
  ended.samples_sha256 = found->samples_sha256;
  ended.reusable = true;
  ended.cached = true;
  CCST_RETURN_IF_ERROR(store_.EndJob(ended, history));
  return Restore(ended);
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Find(const std::string& owner,
                                                      const std::string& id) {
  std::shared_ptr<Job> job;
  {
    MutexLock lock(mutex_);
    if (const auto live = live_.find(id); live != live_.end()) {
      job = live->second;
    } else if (const auto ended = ended_.find(id); ended != ended_.end()) {
      job = ended->second.lock();
    }
  }
  if (job != nullptr) {
    if (job->spec().owner != owner) return NotFound(id);
    return job;
  }
  std::optional<JobRecord> record;
  CCST_ASSIGN_OR_RETURN(record, store_.GetJob(id));
  if (!record.has_value() || record->owner != owner) return NotFound(id);
  // Not live and not ended: it was put back while the server drains.
  if (!HasEnded(record->state)) {
    return MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining,
                     "the server is going away; the job goes on when it is back");
  }
  return Restore(*record);
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Restore(const JobRecord& record) {
  std::string history;
  CCST_ASSIGN_OR_RETURN(history, store_.GetHistory(record.id));
  std::vector<AlternationReport> reports;
  CCST_ASSIGN_OR_RETURN(reports, records_.ReportsOf(history));
  JobSpec spec;
  CCST_ASSIGN_OR_RETURN(spec, records_.SpecOf(record));
  JobView view;
  CCST_ASSIGN_OR_RETURN(view, records_.ViewOf(record));
  std::shared_ptr<Job> job = std::make_unique<Job>(
      record.id, std::move(spec), dependencies_.run.clock, std::move(view), std::move(reports));
  MutexLock lock(mutex_);
  std::weak_ptr<Job>& known = ended_[record.id];
  if (auto other = known.lock()) return other;
  known = job;
  return job;
}

absl::StatusOr<Page<JobSummary>> JobManager::List(const JobFilter& filter, int page_size,
                                                  const std::string& page_token) {
  // One that runs is stored as one that waits, which it would be after a restart.
  JobFilter stored = filter;
  const auto has = [&](JobState state) {
    return std::find(filter.states.begin(), filter.states.end(), state) != filter.states.end();
  };
  if (has(JobState::kRunning)) stored.states.push_back(JobState::kQueued);
  Page<JobRecord> records;
  CCST_ASSIGN_OR_RETURN(records, store_.ListJobs(stored, page_size, page_token));
  Page<JobSummary> page{.records = {}, .next_token = std::move(records.next_token)};
  for (const JobRecord& record : records.records) {
    std::shared_ptr<Job> live;
    {
      MutexLock lock(mutex_);
      if (const auto found = live_.find(record.id); found != live_.end()) live = found->second;
      if (const auto found = unstored_.find(record.id); found != unstored_.end()) {
        live = found->second;
      }
    }
    JobSummary summary{.id = record.id, .spec = {}, .view = {}};
    if (live != nullptr) {
      summary.spec = live->spec();
      summary.view = live->View();
    } else {
      CCST_ASSIGN_OR_RETURN(summary.view, records_.ViewOf(record));
      auto spec = records_.SpecOf(record);
      // One that is damaged shall not hide the others.
      if (!spec.ok()) summary.view.error = spec.status();
      if (spec.ok()) summary.spec = *std::move(spec);
    }
    const bool put_back = IsPutBack(summary.spec, summary.view);
    const JobState state = put_back ? JobState::kQueued : summary.view.state;
    if (!filter.states.empty() && !has(state)) continue;
    page.records.push_back(std::move(summary));
  }
  return page;
}

void JobManager::Stop(Job& job, StopCause cause) {
  if (runner_->Cancel(job, cause)) dependencies_.observer->OnCancel(CauseName(cause));
}

absl::Status JobManager::Cancel(const std::shared_ptr<Job>& job, StopCause cause) {
  // The wish first: a server that is killed between the two must not run the job again. Also of a
  // job that a drain has put back meanwhile; one that has ended stays as it is.
  if (!job->spec().ends_with_caller) CCST_RETURN_IF_ERROR(store_.MarkCancelling(job->id()));
  {
    MutexLock lock(mutex_);
    if (!live_.contains(job->id())) return absl::OkStatus();
  }
  Stop(*job, cause);
  const JobView view = job->View();
  // What runs is stored when its worker lets go of it.
  if (!HasEnded(view.state) || view.start_time.has_value()) return absl::OkStatus();
  return StoreEnd(*job, view);
}

void JobManager::Run(const std::shared_ptr<Job>& job, std::shared_ptr<void> grant) {
  auto outcome = RunJob(*job, dependencies_.run,
                        {.source = {.load =
                                        [this](const std::string& sha256) {
                                          return ReadWhole(store_.blobs(), sha256);
                                        },
                                    .decoders = decoders_,
                                    .grant = grant},
                         .observer = *dependencies_.observer});
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

void JobManager::Finish(const std::shared_ptr<Job>& job, absl::StatusOr<JobResult> outcome) {
  SampleSet samples;
  if (outcome.ok()) samples = std::exchange(outcome->run.samples, {});
  JobView end = job->Seal(std::move(outcome));
  end.expire_time = *end.end_time + options_.retention;
  const bool put_back = IsPutBack(job->spec(), end);
  absl::Status stored;
  std::unique_ptr<BlobPins::Pin> pin;
  if (end.result != nullptr) {
    auto blob = StoreSamples(samples, end);
    stored = blob.status();
    if (blob.ok()) pin = std::make_unique<BlobPins::Pin>(pins_, *blob);
  }
  if (stored.ok() && !put_back) stored = StoreEnd(*job, end);
  if (!stored.ok()) {
    end.state = JobState::kFailed;
    end.error = stored;
    end.result = nullptr;
    end.samples_blob.clear();
    // A record needs less room than samples do. Sweep() tries again.
    stored = StoreEnd(*job, end);
  }
  dependencies_.observer->OnEnd(StateName(end.state),
                                absl::ToDoubleSeconds(*end.end_time - end.create_time));
  {
    MutexLock lock(mutex_);
    live_.erase(job->id());
    if (!put_back) ended_[job->id()] = job;
    if (!stored.ok()) unstored_[job->id()] = job;
  }
  job->Publish(std::move(end));
}

absl::StatusOr<std::string> JobManager::StoreSamples(const SampleSet& samples, JobView& end) {
  std::unique_ptr<BlobWriter> writer;
  CCST_ASSIGN_OR_RETURN(writer, store_.blobs().NewBlob());
  CCST_RETURN_IF_ERROR(WriteSamples(samples, *writer));
  end.samples_blob = writer->Seal();
  CCST_RETURN_IF_ERROR(writer->Commit());
  return end.samples_blob;
}

absl::Status JobManager::StoreEnd(const Job& job, const JobView& end) {
  CCST_RETURN_IF_ERROR(
      store_.EndJob(records_.Ended(job, end, options_.retention), records_.History(job)));
  MutexLock lock(mutex_);
  live_.erase(job.id());
  return absl::OkStatus();
}

absl::Status JobManager::Delete(const std::string& owner, const std::string& id) {
  std::optional<JobRecord> record;
  CCST_ASSIGN_OR_RETURN(record, store_.GetJob(id));
  if (!record.has_value() || record->owner != owner) return NotFound(id);
  if (!HasEnded(record->state)) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded,
                     "jobs/" + id + " has not ended; cancel it first");
  }
  return DeleteRecord(*record);
}

absl::Status JobManager::DeleteRecord(const JobRecord& record) {
  CCST_RETURN_IF_ERROR(store_.DeleteJob(record.id));
  {
    MutexLock lock(mutex_);
    ended_.erase(record.id);
  }
  for (const std::string* blob :
       {&record.samples_sha256, &record.texture_sha256, &record.mesh_sha256}) {
    CCST_RETURN_IF_ERROR(pins_.Drop(*blob));
  }
  return absl::OkStatus();
}

absl::StatusOr<StoredSamples> JobManager::OpenSamples(const Job& job) const {
  const JobView view = job.View();
  if (!HasEnded(view.state)) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded,
                     job.name() + " has not ended; watch it until it has");
  }
  if (view.result == nullptr) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobHasNoSamples,
                     job.name() + " failed or was cancelled");
  }
  std::shared_ptr<const Blob> blob;
  CCST_ASSIGN_OR_RETURN(blob, store_.blobs().Open(view.samples_blob));
  return StoredSamples::Open(std::move(blob));
}

absl::StatusOr<std::int64_t> JobManager::Watch(Job& job, std::function<void()> watcher,
                                               int preview_sample_count) {
  const auto id =
      job.AddWatcher(std::move(watcher), preview_sample_count, options_.max_watchers_per_job);
  if (!id.has_value()) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQuotaExceeded,
                     job.name() + " has " + std::to_string(options_.max_watchers_per_job) +
                         " watchers, which is max_watchers_per_job");
  }
  MutexLock lock(mutex_);
  ++watchers_;
  return *id;
}

void JobManager::Unwatch(Job& job, std::int64_t watcher) {
  job.RemoveWatcher(watcher);
  MutexLock lock(mutex_);
  --watchers_;
  changed_.notify_all();
}

absl::Status JobManager::Sweep() {
  std::vector<std::shared_ptr<Job>> live;
  std::vector<std::shared_ptr<Job>> unstored;
  {
    MutexLock lock(mutex_);
    for (const auto& [id, job] : live_) live.push_back(job);
    for (const auto& [id, job] : unstored_) unstored.push_back(job);
    std::erase_if(ended_, [](const auto& entry) { return entry.second.expired(); });
  }
  for (const auto& job : unstored) {
    const JobView end = job->View();
    if (!HasEnded(end.state)) continue;  // Its end is about to be published.
    CCST_RETURN_IF_ERROR(StoreEnd(*job, end));
    MutexLock lock(mutex_);
    unstored_.erase(job->id());
  }
  for (const auto& job : live) {
    const auto& abandon_seconds = job->spec().abandon_seconds;
    if (abandon_seconds.has_value() && job->UnwatchedSeconds() > *abandon_seconds) {
      CCST_RETURN_IF_ERROR(Cancel(job, StopCause::kAbandoned));
    }
  }
  std::vector<std::string> expired;
  CCST_ASSIGN_OR_RETURN(expired, store_.ExpiredJobs(dependencies_.run.clock.now(), kSweepBatch));
  for (const std::string& id : expired) {
    std::optional<JobRecord> record;
    CCST_ASSIGN_OR_RETURN(record, store_.GetJob(id));
    if (record.has_value()) CCST_RETURN_IF_ERROR(DeleteRecord(*record));
  }
  return absl::OkStatus();
}

bool JobManager::WaitUntilIdle(absl::Duration timeout) {
  const auto deadline = std::chrono::steady_clock::now() +
                        absl::ToChronoNanoseconds(std::min(timeout, absl::Hours(24 * 365)));
  if (!runner_->WaitUntilIdle(timeout)) return false;
  MutexLock lock(mutex_);
  while (storing_ > 0 || watchers_ > 0) {
    if (changed_.wait_until(mutex_, deadline) == std::cv_status::timeout) {
      return storing_ == 0 && watchers_ == 0;
    }
  }
  return true;
}

int JobManager::watcher_count() const {
  MutexLock lock(mutex_);
  return watchers_;
}

}  // namespace ccst::server
