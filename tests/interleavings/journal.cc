#include "tests/interleavings/journal.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"
#include "tests/interleavings/messages.h"

namespace ccst::interleavings {
namespace {

constexpr std::size_t kMostFaults = 20;

bool HasEnded(v1::Job::State state) { return state >= v1::Job::STATE_SUCCEEDED; }

std::string NameOf(v1::Job::State state) { return v1::Job::State_Name(state); }

}  // namespace

Journal::Journal(std::function<absl::Time()> now, absl::Duration retention)
    : now_(std::move(now)), retention_(retention) {}

Moment Journal::Take() { return {.tick = ++tick_, .time = now_()}; }

Moment Journal::Begin() {
  const std::lock_guard lock(mutex_);
  ++calls_;
  return Take();
}

Moment Journal::BeginCreate(int owner, const v1::CreateJobRequest& request) {
  const std::lock_guard lock(mutex_);
  ++calls_;
  asked_[{owner, request.request_id()}].insert(SpecKey(request.spec()));
  const Moment begin = Take();
  creating_[{owner, request.request_id()}].push_back(begin);
  return begin;
}

Moment Journal::BeginCancel(const std::string& job) {
  const std::lock_guard lock(mutex_);
  ++calls_;
  const Moment begin = Take();
  KnownJob& known = jobs_[job];
  if (!known.cancel.has_value()) known.cancel = begin.tick;
  return begin;
}

Moment Journal::BeginDelete(const std::string& job) {
  const std::lock_guard lock(mutex_);
  ++calls_;
  const Moment begin = Take();
  jobs_[job].removals.push_back({.begin = begin.tick, .end = {}});
  return begin;
}

Moment Journal::BeginUpload(int owner, const std::string& mesh) {
  const std::lock_guard lock(mutex_);
  ++calls_;
  const Moment begin = Take();
  meshes_[{owner, mesh}].uploads.push_back({.begin = begin.tick, .end = {}});
  return begin;
}

Moment Journal::BeginDeleteMesh(int owner, const std::string& mesh) {
  const std::lock_guard lock(mutex_);
  ++calls_;
  const Moment begin = Take();
  meshes_[{owner, mesh}].removals.push_back({.begin = begin.tick, .end = {}});
  return begin;
}

void Journal::Close(std::vector<Interval>& calls, const Moment& begin, const Moment& end,
                    bool took_effect) {
  const auto call = std::find_if(calls.begin(), calls.end(), [&](const Interval& interval) {
    return interval.begin == begin.tick;
  });
  if (!took_effect) {
    calls.erase(call);
  } else {
    call->end = end.tick;
  }
}

// What may have been so: a removal under way may be over or not have begun.

bool Journal::MayBeGone(const KnownJob& job, const Moment& by) const {
  return by.time >= job.asked.time + retention_ ||
         std::any_of(job.removals.begin(), job.removals.end(),
                     [&](const Interval& removal) { return removal.begin < by.tick; });
}

bool Journal::IsGone(const KnownJob& job, const Moment& since) {
  return std::any_of(job.removals.begin(), job.removals.end(), [&](const Interval& removal) {
    return removal.end.has_value() && *removal.end < since.tick;
  });
}

bool Journal::IsThere(const KnownMesh& mesh, const Moment& begin, const Moment& end) {
  return std::any_of(mesh.uploads.begin(), mesh.uploads.end(), [&](const Interval& upload) {
    if (!upload.end.has_value() || *upload.end >= begin.tick) return false;
    return std::none_of(mesh.removals.begin(), mesh.removals.end(), [&](const Interval& removal) {
      return removal.end.value_or(end.tick) > upload.begin && removal.begin < end.tick;
    });
  });
}

bool Journal::IsMissing(const KnownMesh& mesh, const Moment& begin) {
  if (mesh.uploads.empty()) return true;
  return std::any_of(mesh.removals.begin(), mesh.removals.end(), [&](const Interval& removal) {
    if (!removal.end.has_value() || *removal.end >= begin.tick) return false;
    return std::all_of(mesh.uploads.begin(), mesh.uploads.end(), [&](const Interval& upload) {
      return upload.end.has_value() && *upload.end < removal.begin;
    });
  });
}

void Journal::Created(int owner, const v1::CreateJobRequest& request, const Moment& begin,
                      const absl::StatusOr<v1::Job>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  std::vector<Moment>& creating = creating_[{owner, request.request_id()}];
  const bool may_be_others = !request.request_id().empty() && !creating.empty();
  const Moment oldest = may_be_others ? creating.front() : begin;
  std::erase_if(creating, [&](const Moment& call) { return call.tick == begin.tick; });
  // Where two specs are asked for under one id, one of them is refused.
  if (GetErrorReason(answer.status()) == ErrorReason::kRequestInvalid &&
      asked_[{owner, request.request_id()}].size() > 1) {
    return;
  }
  if (!answer.ok()) {
    return CheckMissing("CreateJob", owner, request.spec().mesh(), begin, end, answer.status());
  }
  KnownJob& known = jobs_[answer->name()];
  // Another call with the id that is under way still may have made it, when it began.
  if (known.acknowledged == 0) known.asked = oldest;
  Acknowledge(owner, request.request_id(), SpecKey(request.spec()), *answer, begin, end);
}

void Journal::TookSamples(int owner, const v1::SampleRequest& request, bool left,
                          const Moment& begin, const absl::StatusOr<Sampled>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  if (!answer.ok()) {
    return CheckMissing("Sample", owner, request.mesh_name(), begin, end, answer.status());
  }
  const std::string spec = SpecKey(request);
  KnownJob& known = jobs_[answer->end.name()];
  if (left) known.cancel = begin.tick;
  if (known.acknowledged == 0) known.asked = begin;
  Acknowledge(owner, "", spec, answer->end, begin, end);
  if (left) return;
  if (answer->end.state() != v1::Job::STATE_SUCCEEDED) {
    return Fault(answer->end.name(), "Sample ended " + NameOf(answer->end.state()));
  }
  CheckDigest(answer->end.name(), spec, answer->samples);
}

void Journal::Acknowledge(int owner, const std::string& request_id, const std::string& spec,
                          const v1::Job& job, const Moment& begin, const Moment& end) {
  const std::string& name = job.name();
  KnownJob& known = jobs_[name];
  if (known.acknowledged == 0) {
    known.owner = owner;
    known.request_id = request_id;
    known.spec = spec;
  } else if (request_id.empty() || known.request_id != request_id || known.owner != owner) {
    Fault(name, "was given to two calls of which the request_id or the caller differ");
  } else if (known.spec != spec) {
    Fault(name, "was given for request_id " + request_id + " and another spec");
  } else if (IsGone(known, begin)) {
    Fault(name, "was given for request_id " + request_id + " after it had been deleted");
  }
  known.acknowledged = end.tick;
  CheckState(name, known, job, begin, end);
  if (request_id.empty()) return;
  std::set<std::string>& same = requests_[{owner, request_id}];
  for (const std::string& other_name : same) {
    const KnownJob& other = jobs_.at(other_name);
    const Moment other_end = {.tick = other.acknowledged, .time = end.time};
    if (other_name != name && !MayBeGone(other, end) && !MayBeGone(known, other_end)) {
      Fault(name, "and " + other_name + " are both of request_id " + request_id);
    }
  }
  same.insert(name);
}

void Journal::CheckMissing(const std::string& call, int owner, const std::string& mesh,
                           const Moment& begin, const Moment& end, const absl::Status& answer) {
  const bool is_missing = GetErrorReason(answer) == ErrorReason::kMeshMissing ||
                          GetErrorReason(answer) == ErrorReason::kNotFound;
  if (!mesh.empty() && is_missing && !IsThere(meshes_[{owner, mesh}], begin, end)) return;
  Fault(call + (mesh.empty() ? " with its own mesh" : " on " + mesh), "says " + Text(answer));
}

Journal::KnownJob* Journal::Found(int owner, const std::string& name, const char* call,
                                  const Moment& begin, const Moment& end,
                                  const absl::Status& answer) {
  KnownJob& job = jobs_.at(name);
  const bool is_missing = GetErrorReason(answer) == ErrorReason::kNotFound;
  if (answer.ok() && job.owner != owner) Fault(name, std::string(call) + " serves another owner");
  if (answer.ok() && IsGone(job, begin)) Fault(name, std::string(call) + " finds it deleted");
  if (answer.ok()) return &job;
  if (is_missing && (job.owner != owner || MayBeGone(job, end))) return nullptr;
  Fault(name, std::string(call) + " says " + Text(answer) +
                  (is_missing ? ", and nobody deleted it" : ""));
  return nullptr;
}

void Journal::Saw(int owner, const std::string& job, const Moment& begin,
                  const absl::StatusOr<v1::Job>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  KnownJob* const known = Found(owner, job, "GetJob or CancelJob", begin, end, answer.status());
  if (known != nullptr) CheckState(job, *known, *answer, begin, end);
}

void Journal::SawEnd(int owner, const std::string& job, const Moment& begin,
                     const absl::StatusOr<Watched>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  KnownJob* const known = Found(owner, job, "WatchJob", begin, end, answer.status());
  if (known == nullptr) return;
  CheckState(job, *known, answer->end, begin, end);
  const v1::Job& last = answer->end;
  if (!HasEnded(last.state())) Fault(job, "WatchJob ended while it was " + NameOf(last.state()));
  if (!last.has_result()) return;
  // The first report is of the initial set, which white noise is already.
  const int right = last.effective_options().method() == v1::SAMPLING_METHOD_WHITE_NOISE
                        ? 0
                        : last.result().iteration_count() + 1;
  if (answer->report_count != right) {
    Fault(job, "WatchJob gave " + std::to_string(answer->report_count) + " reports of " +
                   std::to_string(right));
  }
}

void Journal::CheckState(const std::string& name, KnownJob& job, const v1::Job& answer,
                         const Moment& begin, const Moment& end) {
  const v1::Job::State state = answer.state();
  if (job.seen_ended.has_value() && *job.seen_ended < begin.tick && job.end != state) {
    Fault(name, "was " + NameOf(job.end) + " and is " + NameOf(state));
  }
  const bool stops = state == v1::Job::STATE_CANCELLED || state == v1::Job::STATE_CANCELLING;
  if (stops && job.cancel.value_or(end.tick) >= end.tick) {
    Fault(name, "is " + NameOf(state) + ", and nobody asked for that");
  }
  if (state == v1::Job::STATE_FAILED) Fault(name, "FAILED: " + answer.error().message());
  if (state == v1::Job::STATE_SUCCEEDED) {
    CheckDigest(name, job.spec, answer.result().samples_digest().sha256());
  }
  if (HasEnded(state) && !job.seen_ended.has_value()) {
    job.seen_ended = end.tick;
    job.end = state;
  }
}

void Journal::CheckDigest(const std::string& name, const std::string& spec,
                          const std::string& digest) {
  const std::string& right = digests_.emplace(spec, digest).first->second;
  if (digest != right) Fault(name, "has samples " + digest + ", an equal one had " + right);
}

void Journal::Read(int owner, const std::string& job, const Moment& begin,
                   const absl::StatusOr<std::string>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  const KnownJob& known = jobs_.at(job);
  const bool ended = known.seen_ended.has_value() && *known.seen_ended < begin.tick;
  const auto reason = GetErrorReason(answer.status());
  if (reason == ErrorReason::kJobNotEnded && known.owner == owner && !ended) return;
  if (reason == ErrorReason::kJobHasNoSamples && known.owner == owner &&
      (!ended || known.end != v1::Job::STATE_SUCCEEDED)) {
    return;
  }
  if (Found(owner, job, "ReadSamples", begin, end, answer.status()) == nullptr) return;
  CheckDigest(job, known.spec, *answer);
}

void Journal::Listed(int owner, const Moment& begin,
                     const absl::StatusOr<std::vector<v1::Job>>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  if (!answer.ok()) return Fault("ListJobs", "says " + Text(answer.status()));
  std::set<std::string> names;
  for (const v1::Job& job : *answer) {
    if (!names.insert(job.name()).second) Fault(job.name(), "is listed twice");
    const auto known = jobs_.find(job.name());
    // One that nobody was told of yet is another call's under way.
    if (known == jobs_.end() || known->second.acknowledged == 0) continue;
    if (Found(owner, job.name(), "ListJobs", begin, end, absl::OkStatus()) != nullptr) {
      CheckState(job.name(), known->second, job, begin, end);
    }
  }
  for (const auto& [name, job] : jobs_) {
    const bool was_there = job.acknowledged > 0 && job.acknowledged < begin.tick;
    if (job.owner == owner && was_there && !MayBeGone(job, end) && !names.contains(name)) {
      Fault(name, "is not listed, and nobody deleted it");
    }
  }
}

void Journal::Deleted(int owner, const std::string& job, const Moment& begin,
                      const absl::Status& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  KnownJob& known = jobs_.at(job);
  Close(known.removals, begin, end, answer.ok());
  const bool ended = known.seen_ended.has_value() && *known.seen_ended < begin.tick;
  if (GetErrorReason(answer) == ErrorReason::kJobNotEnded && known.owner == owner && !ended) return;
  Found(owner, job, "DeleteJob", begin, end, answer);
}

void Journal::Uploaded(int owner, const std::string& mesh, const Moment& begin,
                       const absl::Status& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  Close(meshes_[{owner, mesh}].uploads, begin, end, answer.ok());
  if (!answer.ok()) Fault(mesh, "its upload says " + Text(answer));
}

void Journal::Downloaded(int owner, const std::string& mesh, const std::string& right,
                         const Moment& begin, const absl::StatusOr<std::string>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  const KnownMesh& known = meshes_[{owner, mesh}];
  if (!answer.ok()) return CheckMissing("DownloadMesh", owner, mesh, begin, end, answer.status());
  if (*answer != right) Fault(mesh, "DownloadMesh gives other bytes than were uploaded");
  if (IsMissing(known, begin)) Fault(mesh, "DownloadMesh finds it deleted");
}

void Journal::ListedMeshes(int owner, const Moment& begin,
                           const absl::StatusOr<std::vector<std::string>>& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  if (!answer.ok()) return Fault("ListMeshes", "says " + Text(answer.status()));
  for (const auto& [key, mesh] : meshes_) {
    if (key.first != owner) continue;
    const bool listed = std::find(answer->begin(), answer->end(), key.second) != answer->end();
    if (listed && IsMissing(mesh, begin)) Fault(key.second, "is listed after it was deleted");
    if (!listed && IsThere(mesh, begin, end)) {
      Fault(key.second, "is not listed, and nobody deleted it");
    }
  }
}

void Journal::DeletedMesh(int owner, const std::string& mesh, const Moment& begin,
                          const absl::Status& answer) {
  const std::lock_guard lock(mutex_);
  const Moment end = Take();
  KnownMesh& known = meshes_[{owner, mesh}];
  Close(known.removals, begin, end, answer.ok());
  // Others may have jobs on it under way that nobody was told of yet.
  if (answer.ok() || GetErrorReason(answer) == ErrorReason::kMeshInUse) return;
  CheckMissing("DeleteMesh", owner, mesh, begin, end, answer);
}

std::vector<std::string> Journal::Jobs(int owner) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, job] : jobs_) {
    const bool removed = std::any_of(job.removals.begin(), job.removals.end(),
                                     [](const Interval& call) { return call.end.has_value(); });
    if (job.owner == owner && job.acknowledged > 0 && !removed) names.push_back(name);
  }
  return names;
}

int Journal::job_count() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(jobs_.size());
}

int Journal::call_count() const {
  const std::lock_guard lock(mutex_);
  return calls_;
}

void Journal::Fault(const std::string& subject, const std::string& what) {
  if (faults_.size() < kMostFaults) faults_.push_back(subject + ": " + what);
}

void Journal::AddFault(std::string fault) {
  const std::lock_guard lock(mutex_);
  if (faults_.size() < kMostFaults) faults_.push_back(std::move(fault));
}

std::vector<std::string> Journal::faults() const {
  const std::lock_guard lock(mutex_);
  return faults_;
}

std::vector<std::string> FaultsAtRest(const std::vector<v1::Job>& jobs,
                                      const std::set<std::string>& meshes,
                                      const Holdings& holdings) {
  std::vector<std::string> faults;
  std::set<std::string> needed = meshes;
  std::set<std::string> samples;
  for (const v1::Job& job : jobs) {
    needed.insert(job.mesh());
    if (job.has_result()) samples.insert(job.result().samples_digest().sha256());
    if (!HasEnded(job.state())) faults.push_back(job.name() + " is " + NameOf(job.state()));
  }
  std::int64_t bytes = 0;
  std::size_t others = 0;
  for (const auto& [sha256, size] : holdings.blobs) {
    bytes += size;
    // Samples are stored under another digest than that of the API.
    if (needed.erase("meshes/" + sha256) == 0) ++others;
  }
  for (const std::string& mesh : needed) faults.push_back(mesh + " is needed, its bytes are gone");
  const auto count = [&](std::int64_t actual, const char* what, std::int64_t right,
                         const char* why) {
    if (actual == right) return;
    faults.push_back(std::to_string(actual) + what + std::to_string(right) + why);
  };
  count(static_cast<std::int64_t>(others), " blobs are no listed mesh, ",
        static_cast<std::int64_t>(samples.size()), " different samples are listed");
  count(holdings.counted_bytes, " bytes are counted, ", bytes, " are stored");
  count(holdings.memory_bytes, " bytes of memory are in use, ", 0, " should be");
  count(holdings.watchers, " watchers are counted, ", 0, " are there");
  return faults;
}

}  // namespace ccst::interleavings
