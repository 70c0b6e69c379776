#include "server/jobs/job_manager.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"
#include "server/base/deadline.h"
#include "server/formats/job_history.h"
#include "server/jobs/job_records.h"
#include "server/jobs/stored_samples.h"
#include "server/meshes/pinned_blob.h"

namespace ccst::server {
namespace {

// How often watchers hear of a job that goes on. Nobody sees less, and small jobs take less time.
constexpr std::chrono::milliseconds kNewsInterval(10);
// Of meshes that only jobs in memory have.
constexpr std::int64_t kMostHeldBytes = std::int64_t{32} << 20;
// How often the process may die while a job runs.
constexpr int kMostUncleanEnds = 2;
// Dropped in one change of the records; others use the store between two of them.
constexpr int kSweepBatch = 100;

absl::Status NotFound(const std::string& id) {
  return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                   "there is no job jobs/" + id + ", or not any more");
}

absl::Status DamagedSamples(const std::string& name, const std::string& what) {
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   absl::StrCat("the samples of ", name, " are lost: ", what,
                                "; the same request again computes them anew"));
}

// How a job is listed of which the record cannot be read.
JobSummary DamagedSummary(const JobRecord& record, const absl::Status& error) {
  // Damaged text may be no UTF-8, which would damage the whole page.
  JobSummary summary{.id = PrintableText(record.id), .spec = {}, .view = {}};
  summary.spec.owner = record.owner;
  summary.spec.mesh_sha256 = PrintableText(record.mesh_sha256);
  summary.spec.display_name = PrintableText(record.display_name);
  summary.view.state = JobState::kFailed;
  summary.view.error = error;
  summary.view.create_time = record.create_time;
  summary.view.expire_time = record.expire_time;
  return summary;
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

absl::Status DiedWithServer(int times) {
  return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                   "the server died " + std::to_string(times) +
                       " times while it ran the job, which it does not run again; the job "
                       "may need "
                       "more memory than there is, or meet a fault of the program");
}

}  // namespace

JobManager::JobManager(Store& store, BlobPins& pins, const JobManagerOptions& options,
                       JobManagerDependencies dependencies)
    : store_(store),
      pins_(pins),
      options_(options),
      dependencies_(std::move(dependencies)),
      budget_(dependencies_.budget != nullptr
                  ? dependencies_.budget
                  : std::make_shared<MemoryBudget>(options.memory_budget_bytes)),
      held_inputs_(std::min(kMostHeldBytes, budget_->limit_bytes() / 64)),
      notifier_(kNewsInterval),
      runs_(store_, pins_, options_, dependencies_, live_, budget_) {}

JobManager::~JobManager() = default;

absl::StatusOr<std::unique_ptr<JobManager>> JobManager::Start(Store& store, BlobPins& pins,
                                                              const JobManagerOptions& options,
                                                              JobManagerDependencies dependencies) {
  std::unique_ptr<JobManager> manager(
      new JobManager(store, pins, options, std::move(dependencies)));
  std::vector<JobRecord> unfinished;
  CCST_ASSIGN_OR_RETURN(unfinished, store.UnfinishedJobs());
  for (const JobRecord& record : unfinished) manager->TakeUp(record);
  return manager;
}

void JobManager::TakeUp(const JobRecord& record) {
  const auto report = [this](const std::string& text) {
    if (dependencies_.report) dependencies_.report(text);
  };
  auto spec = SpecOf(record);
  if (!spec.ok()) {
    // Others shall run nevertheless, also where even this cannot be stored.
    const absl::Status ended = store_.EndJob(
        FailedRecord(record, spec.status(), dependencies_.run.clock.now(), options_.retention), "");
    if (!ended.ok()) report("jobs/" + record.id + " is lost: " + std::string(ended.message()));
    return;
  }
  const bool cancelled = record.state == JobState::kCancelling || spec->ends_with_caller;
  const std::shared_ptr<Job> job = NewJob(record.id, *std::move(spec));
  if (cancelled) {
    job->Cancel(StopCause::kCaller);
    live_.Add(job);
    runs_.StoreEnd(job).IgnoreError();  // Sweep() tries again.
  } else if (record.starts >= kMostUncleanEnds) {
    const absl::Status error = DiedWithServer(record.starts);
    runs_.EndUnrun(job, error);
    report(job->name() + " is FAILED: " + std::string(error.message()));
  } else if (const absl::Status taken = runs_.TakeUp(job, record.starts); !taken.ok()) {
    runs_.EndUnrun(job, taken);
  } else if (record.starts > 0) {
    report(job->name() + " ran when the server died; it runs once more, alone");
  }
}

std::shared_ptr<Job> JobManager::NewJob(std::string id, JobSpec spec,
                                        std::shared_ptr<const HeldInput> held) {
  auto post = [this](std::function<void()> task, Urgency urgency) {
    notifier_.Post(std::move(task), urgency);
  };
  // Not make_shared: a weak pointer of ended_ would keep the job's own memory until the next sweep.
  return std::make_unique<Job>(std::move(id), std::move(spec), dependencies_.run.clock,
                               std::move(post), std::move(held));
}

absl::Status JobManager::Check(const JobSpec& spec) const {
  return AdmittedMemory(spec, nullptr).status();
}

absl::StatusOr<std::int64_t> JobManager::AdmittedMemory(
    const JobSpec& spec, const std::shared_ptr<const HeldInput>& held) const {
  std::int64_t memory = 0;
  CCST_ASSIGN_OR_RETURN(memory, runs_.MemoryOf(spec, held));
  if (memory <= budget_->limit_bytes()) return memory;
  return OverLimit({"max_job_memory_bytes", budget_->limit_bytes(), memory},
                   "the job may need " + std::to_string(memory) +
                       " bytes of memory, over max_job_memory_bytes, " +
                       std::to_string(budget_->limit_bytes()) +
                       "; ask for fewer samples or send a smaller mesh");
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Create(
    const JobSpec& spec, const std::shared_ptr<const HeldInput>& held) {
  // Each time another call has dropped a job in between; more often only damage can do that.
  constexpr int kAttempts = 20;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::shared_ptr<Job> job;
    CCST_ASSIGN_OR_RETURN(job, FindRequest(spec));
    if (job != nullptr) return job;
    CCST_ASSIGN_OR_RETURN(job, Accept(spec, held));
    if (job != nullptr) return job;
  }
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   "the record of the job with this request_id is damaged; use a new one");
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::FindRequest(const JobSpec& spec) {
  if (spec.request_id.empty()) return nullptr;
  std::optional<JobRecord> earlier;
  CCST_ASSIGN_OR_RETURN(earlier, store_.FindRequest(spec.owner, spec.request_id));
  if (!earlier.has_value()) return nullptr;
  bool is_same = false;
  CCST_ASSIGN_OR_RETURN(is_same, IsOf(*earlier, spec));
  if (!is_same) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kRequestInvalid,
                     "the request_id '" + spec.request_id + "' was used for jobs/" + earlier->id +
                         ", which has another mesh or other options; use a new one");
  }
  auto job = Find(spec.owner, earlier->id);
  if (absl::IsNotFound(job.status())) return nullptr;  // Dropped meanwhile.
  return job;
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Accept(
    const JobSpec& spec, const std::shared_ptr<const HeldInput>& held) {
  std::int64_t memory = 0;
  CCST_ASSIGN_OR_RETURN(memory, AdmittedMemory(spec, held));
  CCST_RETURN_IF_ERROR(store_.blobs().CheckRoom(EstimateStoredBytes(spec.options.sample_count)));
  auto place = runs_.runner().Reserve(spec.share);
  if (!place.ok()) return place.status();
  const JobRecord record = NewRecord(dependencies_.new_id(), spec, dependencies_.run.clock.now());
  CCST_RETURN_IF_ERROR(CheckRecordRoom(
      store_, spec.owner, BytesOf(record) + record.expected_end_bytes, options_.records));
  if (!spec.skip_cache_lookup) {
    std::optional<JobRecord> answered;
    CCST_ASSIGN_OR_RETURN(answered, AnswerFromCache(record, held));
    dependencies_.observer->OnCacheLookup("result", answered.has_value());
    if (answered.has_value()) {
      if (answered->id != record.id) return nullptr;
      auto job = Restore(*answered);
      if (absl::IsNotFound(job.status())) return nullptr;  // Dropped meanwhile.
      return job;
    }
  }
  const std::shared_ptr<Job> job = NewJob(record.id, spec, held);
  live_.Add(job);  // Found from the moment on that it is stored.
  auto stored = store_.AddJob(record);
  if (!stored.ok() || stored->id != record.id) live_.Remove(job->id());
  if (!stored.ok()) return stored.status();
  if (stored->id != record.id) return nullptr;
  runs_.runner().Enqueue(*std::move(place), job, memory);
  return job;
}

absl::StatusOr<std::optional<JobRecord>> JobManager::AnswerFromCache(
    const JobRecord& record, const std::shared_ptr<const HeldInput>& held) {
  const absl::Time now = dependencies_.run.clock.now();
  std::optional<JobRecord> found;
  CCST_ASSIGN_OR_RETURN(found, store_.FindReusable(record.spec_digest, now));
  // What is damaged answers nobody: it is computed again, which heals it.
  if (!found.has_value() || found->damaged) return std::nullopt;
  const BlobPins::Pin pin(pins_, found->samples_sha256);
  if (!store_.blobs().Check(found->samples_sha256).ok()) return std::nullopt;
  const auto history = store_.GetHistory(found->id);
  if (absl::IsDataLoss(history.status())) return std::nullopt;
  if (!history.ok()) return history.status();
  // The history of one that was dropped meanwhile reads as none.
  std::optional<JobRecord> kept;
  CCST_ASSIGN_OR_RETURN(kept, store_.GetJob(found->id));
  if (!kept.has_value()) return std::nullopt;
  // It is there as a rule, as the other job has it too; the caller's pin keeps it.
  if (held != nullptr && !store_.blobs().Check(held->sha256).ok()) {
    CCST_RETURN_IF_ERROR(PutWhole(store_.blobs(), held->bytes).status());
  }
  return store_.AddEndedJob(AnsweredRecord(record, *found, now, options_.retention), *history);
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Find(const std::string& owner,
                                                      const std::string& id) {
  if (std::shared_ptr<Job> job = live_.Find(id); job != nullptr) {
    if (job->spec().owner != owner) return NotFound(id);
    return job;
  }
  std::optional<JobRecord> record;
  CCST_ASSIGN_OR_RETURN(record, store_.GetJob(id));
  if (!record.has_value() || record->owner != owner) return NotFound(id);
  // Not live and not ended: it was put back while the server drains, or was never taken up.
  if (!HasEnded(record->state) && !record->damaged) {
    return MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining,
                     "the server is going away; the job goes on when it is back");
  }
  return Restore(*record);
}

absl::StatusOr<std::shared_ptr<Job>> JobManager::Restore(const JobRecord& record) {
  JobSpec spec;
  CCST_ASSIGN_OR_RETURN(spec, SpecOf(record));
  JobView view;
  CCST_ASSIGN_OR_RETURN(view, ViewOf(record));
  // A damaged history keeps nobody from the result.
  const auto history = store_.GetHistory(record.id);
  if (!history.ok() && !absl::IsDataLoss(history.status())) return history.status();
  absl::StatusOr<std::vector<AlternationReport>> reports = std::vector<AlternationReport>();
  if (history.ok()) {
    reports = DecodeHistory(*history);
  } else {
    reports = history.status();
  }
  std::shared_ptr<Job> job = std::make_unique<Job>(
      record.id, std::move(spec), dependencies_.run.clock, std::move(view), std::move(reports));
  job = live_.AddStored(job);
  // One that was dropped meanwhile may lack its history, and whoever dropped it did not find it in
  // memory to forget it.
  std::optional<JobRecord> kept;
  CCST_ASSIGN_OR_RETURN(kept, store_.GetJob(record.id));
  if (kept.has_value()) return job;
  live_.Forget(record.id);
  return NotFound(record.id);
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
    const std::shared_ptr<Job> live = live_.FindUnstored(record.id);
    JobSummary summary{.id = record.id, .spec = {}, .view = {}};
    if (live != nullptr) {
      summary.spec = live->spec();
      summary.view = live->View();
    } else {
      auto spec = SpecOf(record);
      auto view = ViewOf(record);
      const absl::Status readable = spec.ok() ? view.status() : spec.status();
      if (!readable.ok()) {
        // One that is damaged must not hide the others, whatever state was asked for.
        page.records.push_back(DamagedSummary(record, readable));
        continue;
      }
      summary.spec = *std::move(spec);
      summary.view = *std::move(view);
    }
    const bool put_back = IsPutBack(summary.spec, summary.view);
    const JobState state = put_back ? JobState::kQueued : summary.view.state;
    if (!filter.states.empty() && !has(state)) continue;
    page.records.push_back(std::move(summary));
  }
  return page;
}

void JobManager::Stop(Job& job, StopCause cause) {
  if (runs_.runner().Cancel(job, cause)) dependencies_.observer->OnCancel(CauseName(cause));
}

absl::Status JobManager::Cancel(const std::shared_ptr<Job>& job, StopCause cause) {
  // The wish first: a server that is killed between the two must not run the job again. Also of a
  // job that a drain has put back meanwhile; one that has ended stays as it is.
  absl::Status marked;
  if (!job->spec().ends_with_caller) marked = store_.MarkCancelling(job->id());
  if (live_.FindUnstored(job->id()) == nullptr) return marked;
  Stop(*job, cause);
  // What runs is stored when its worker lets go of it; what the disk does not take now, by Sweep().
  runs_.StoreEnd(job).IgnoreError();
  return marked;
}

void JobManager::StopAll() {
  for (int i = runs_.runner().StopAll(); i > 0; --i) dependencies_.observer->OnCancel("drain");
}

absl::Status JobManager::Delete(const std::string& owner, const std::string& id) {
  std::optional<JobRecord> record;
  CCST_ASSIGN_OR_RETURN(record, store_.GetJob(id));
  if (!record.has_value() || record->owner != owner) return NotFound(id);
  if (!HasEnded(record->state)) {
    // It may have ended while the disk was full.
    if (const auto job = live_.FindUnstored(id); job != nullptr) {
      CCST_RETURN_IF_ERROR(runs_.StoreEnd(job));
    }
    CCST_ASSIGN_OR_RETURN(record, store_.GetJob(id));
    if (!record.has_value()) return NotFound(id);
  }
  if (!HasEnded(record->state)) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded,
                     "jobs/" + id + " has not ended; cancel it first");
  }
  return DeleteRecord(*record);
}

absl::Status JobManager::DeleteRecord(const JobRecord& record) {
  CCST_RETURN_IF_ERROR(store_.DeleteJob(record.id));
  live_.Forget(record.id);
  absl::Status dropped;
  for (const std::string* blob :
       {&record.samples_sha256, &record.texture_sha256, &record.mesh_sha256}) {
    dropped.Update(pins_.Drop(*blob));
  }
  return dropped;
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
  const auto blob = OpenPinned(store_.blobs(), pins_, view.samples_blob);
  if (absl::IsNotFound(blob.status())) {
    std::optional<JobRecord> record;
    CCST_ASSIGN_OR_RETURN(record, store_.GetJob(job.id()));
    return record.has_value() ? DamagedSamples(job.name(), "their file is gone")
                              : NotFound(job.id());
  }
  if (!blob.ok()) return blob.status();
  auto stored = StoredSamples::Open(*blob);
  absl::Status whole = stored.status();
  if (stored.ok() && !stored->has_sums()) whole = store_.blobs().Check(view.samples_blob);
  if (whole.ok()) return stored;
  (*blob)->Doubt();
  return absl::IsDataLoss(whole) ? DamagedSamples(job.name(), std::string(whole.message())) : whole;
}

absl::StatusOr<std::int64_t> JobManager::Watch(Job& job, std::function<void()> watcher,
                                               int preview_sample_count) {
  const auto id =
      job.AddWatcher(std::move(watcher), preview_sample_count, options_.max_watchers_per_job);
  if (!id.has_value()) {
    return OverQuota(
        {"max_watchers_per_job", options_.max_watchers_per_job, options_.max_watchers_per_job + 1},
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
  live_.Tidy();
  absl::Status first = DropExpired();  // Makes room for the rest.
  first.Update(runs_.StoreEnds());
  for (const auto& job : live_.Unstored()) {
    const auto& abandon_seconds = job->spec().abandon_seconds;
    if (abandon_seconds.has_value() && job->UnwatchedSeconds() > *abandon_seconds) {
      first.Update(Cancel(job, StopCause::kAbandoned));
    }
  }
  Resume();
  return first;
}

absl::Status JobManager::DropExpired() {
  absl::Status first;
  std::vector<DroppedJob> dropped;
  do {
    auto batch = store_.DropExpiredJobs(dependencies_.run.clock.now(), kSweepBatch);
    if (!batch.ok()) {
      first.Update(batch.status());
      return first;
    }
    dropped = *std::move(batch);
    std::set<std::string> blobs;
    for (const DroppedJob& job : dropped) {
      live_.Forget(job.id);
      blobs.insert(job.blobs.begin(), job.blobs.end());
    }
    for (const std::string& sha256 : blobs) first.Update(pins_.Drop(sha256));
  } while (!dropped.empty());
  return first;
}

bool JobManager::WaitUntilIdle(absl::Duration timeout) {
  const auto deadline = DeadlineAfter(timeout);
  if (!runs_.WaitUntilIdle(timeout)) return false;
  MutexLock lock(mutex_);
  while (watchers_ > 0) {
    if (changed_.wait_until(mutex_, deadline) == std::cv_status::timeout) return watchers_ == 0;
  }
  return true;
}

int JobManager::watcher_count() const {
  MutexLock lock(mutex_);
  return watchers_;
}

}  // namespace ccst::server
