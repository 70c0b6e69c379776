#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "tests/interleavings/service.h"

namespace ccst::interleavings {

/// A place in the order of everything that clients did.
struct Moment {
  std::int64_t tick = 0;
  absl::Time time;  ///< By the clock of the service.
};

/// What clients asked for and were answered. Every answer is held against those before it: a call
/// takes effect at some moment between its begin and its end, and an answer that contradicts every
/// such order is a fault. So the journal knows when NOT_FOUND is right, because somebody may have
/// deleted the job by then, and when a job was lost. Thread-safe.
class Journal {
 public:
  /// @param now        the clock of the service.
  /// @param retention  how long the service keeps jobs after their end.
  Journal(std::function<absl::Time()> now, absl::Duration retention);

  /// A call begins. To be asked for before the call is made; of calls that change how others are
  /// answered, by the functions that say what they change.
  Moment Begin();
  Moment BeginCreate(int owner, const v1::CreateJobRequest& request);
  Moment BeginCancel(const std::string& job);
  Moment BeginDelete(const std::string& job);
  Moment BeginUpload(int owner, const std::string& mesh);
  Moment BeginDeleteMesh(int owner, const std::string& mesh);

  // What a call that began at `begin` was answered.

  void Created(int owner, const v1::CreateJobRequest& request, const Moment& begin,
               const absl::StatusOr<v1::Job>& answer);
  /// @param left  the caller went away before the end.
  void TookSamples(int owner, const v1::SampleRequest& request, bool left, const Moment& begin,
                   const absl::StatusOr<Sampled>& answer);
  /// Of GetJob and CancelJob.
  void Saw(int owner, const std::string& job, const Moment& begin,
           const absl::StatusOr<v1::Job>& answer);
  void SawEnd(int owner, const std::string& job, const Moment& begin,
              const absl::StatusOr<Watched>& answer);
  void Read(int owner, const std::string& job, const Moment& begin,
            const absl::StatusOr<std::string>& answer);
  void Listed(int owner, const Moment& begin, const absl::StatusOr<std::vector<v1::Job>>& answer);
  void Deleted(int owner, const std::string& job, const Moment& begin, const absl::Status& answer);

  void Uploaded(int owner, const std::string& mesh, const Moment& begin,
                const absl::Status& answer);
  /// @param right  the bytes that were uploaded under this name.
  void Downloaded(int owner, const std::string& mesh, const std::string& right, const Moment& begin,
                  const absl::StatusOr<std::string>& answer);
  void ListedMeshes(int owner, const Moment& begin,
                    const absl::StatusOr<std::vector<std::string>>& answer);
  void DeletedMesh(int owner, const std::string& mesh, const Moment& begin,
                   const absl::Status& answer);

  /// The owner's jobs that nobody is known to have deleted.
  std::vector<std::string> Jobs(int owner) const;
  int job_count() const;
  int call_count() const;

  void AddFault(std::string fault);
  std::vector<std::string> faults() const;

 private:
  // From the begin of a call to its end, which is empty while it is under way.
  struct Interval {
    std::int64_t begin = 0;
    std::optional<std::int64_t> end;
  };
  struct KnownJob {
    int owner = 0;
    std::string request_id;
    std::string spec;
    Moment asked;                            // When the first call began that may have made it,
    std::int64_t acknowledged = 0;           // and the last that was answered with it ended.
    std::vector<Interval> removals;          // Calls that deleted it, or may yet.
    std::optional<std::int64_t> cancel;      // When the first call that cancels began.
    std::optional<std::int64_t> seen_ended;  // When a call had been answered with its end,
    v1::Job::State end = v1::Job::STATE_UNSPECIFIED;  // which was this.
  };
  struct KnownMesh {
    std::vector<Interval> uploads;
    std::vector<Interval> removals;
  };

  Moment Take();
  void Fault(const std::string& subject, const std::string& what);
  static void Close(std::vector<Interval>& calls, const Moment& begin, const Moment& end,
                    bool took_effect);

  bool MayBeGone(const KnownJob& job, const Moment& by) const;
  static bool IsGone(const KnownJob& job, const Moment& since);
  static bool IsThere(const KnownMesh& mesh, const Moment& begin, const Moment& end);
  static bool IsMissing(const KnownMesh& mesh, const Moment& begin);

  void Acknowledge(int owner, const std::string& request_id, const std::string& spec,
                   const v1::Job& job, const Moment& begin, const Moment& end);
  // The job, where the call went well; judges why not otherwise.
  KnownJob* Found(int owner, const std::string& name, const char* call, const Moment& begin,
                  const Moment& end, const absl::Status& answer);
  void CheckState(const std::string& name, KnownJob& job, const v1::Job& answer,
                  const Moment& begin, const Moment& end);
  void CheckDigest(const std::string& name, const std::string& spec, const std::string& digest);
  void CheckMissing(const std::string& call, int owner, const std::string& mesh,
                    const Moment& begin, const Moment& end, const absl::Status& answer);

  const std::function<absl::Time()> now_;
  const absl::Duration retention_;
  mutable std::mutex mutex_;
  std::int64_t tick_ = 0;
  int calls_ = 0;
  std::map<std::string, KnownJob> jobs_;
  std::map<std::pair<int, std::string>, std::set<std::string>> requests_;  // Jobs by request id.
  std::map<std::pair<int, std::string>, std::set<std::string>> asked_;     // Specs, the same.
  // Calls of CreateJob under way, the same, the oldest first.
  std::map<std::pair<int, std::string>, std::vector<Moment>> creating_;
  std::map<std::pair<int, std::string>, KnownMesh> meshes_;
  std::map<std::string, std::string> digests_;  // Of the samples, by spec.
  std::vector<std::string> faults_;
};

/// What is wrong while nothing is under way: each of `jobs`, which are all that are listed, must
/// have ended, and `holdings` must be what they and `meshes` (by name) need, no more and no less.
std::vector<std::string> FaultsAtRest(const std::vector<v1::Job>& jobs,
                                      const std::set<std::string>& meshes,
                                      const Holdings& holdings);

}  // namespace ccst::interleavings
