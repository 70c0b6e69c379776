#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "ccst/v1/job.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "server/jobs/job.h"

namespace ccst::server {

/// A cursor into what happens to a job. First a snapshot, then every report once, snapshots when
/// something else changed and previews, both the latest only; then the end. Holds nothing of the
/// job's, so that a slow reader costs no memory. Not thread-safe.
class JobEvents {
 public:
  /// @param after_sequence  reports up to this number are left out.
  /// @param preview_count   previews of at most this many points; 0: none.
  JobEvents(std::shared_ptr<const Job> job, std::int64_t after_sequence, int preview_count);

  /// What is next.
  enum class Kind {
    kNothing,   ///< Ask again when the job has changed.
    kSnapshot,  ///< Of the job as it is or was.
    kProgress,
    kPreview,
    kEnd,  ///< The job has ended and all was said but this; from now on always.
  };
  Kind Next();

  // Of the last Next().

  const v1::Job& snapshot() const { return snapshot_; }
  const v1::IterationProgress& progress() const { return progress_; }
  const v1::SamplePreview& preview() const { return preview_; }
  /// Of a report, counted from 1; of the end, one more than the last report's.
  std::int64_t sequence() const { return sequence_; }
  double elapsed_seconds() const { return elapsed_seconds_; }
  /// True when Next() has another report to tell of, now or behind a snapshot.
  bool has_report() const { return job_->Report(next_report_).has_value(); }
  /// The last view, at the end.
  const JobView& end() const { return *end_; }

 private:
  bool TakeSnapshot();
  bool TakeReport();
  bool TakePreview();

  const std::shared_ptr<const Job> job_;
  const int preview_count_;
  std::int64_t seen_version_ = 0;
  std::size_t next_report_;
  std::shared_ptr<const JobPreview> seen_preview_;
  std::optional<JobView> end_;
  v1::Job snapshot_;
  v1::IterationProgress progress_;
  v1::SamplePreview preview_;
  std::int64_t sequence_ = 0;
  double elapsed_seconds_ = 0.0;
};

/// What StreamBytes() should count for a message with an event: a snapshot, a report or a preview
/// of at most `preview_count` points.
std::int64_t EventBytes(int preview_count);

/// What a stream says when the server goes away before its job has ended.
absl::Status GoingAway();

}  // namespace ccst::server
