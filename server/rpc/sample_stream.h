#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <Eigen/Core>

#include "absl/status/status.h"
#include "ccst/v1/sampling_service.pb.h"
#include "server/jobs/job.h"

namespace ccst::server {

/// Turns a job into the messages of a `Sample` stream, one when asked: a cursor into the job's
/// history that holds no message itself, so that a slow reader costs no memory. Not thread-safe.
class SampleStream {
 public:
  /// What there is to do.
  enum class Step {
    kWrite,  ///< `message` was filled.
    kWait,   ///< Nothing new; ask again when the job has changed.
    kEnd,    ///< The stream is over; see end_status().
  };

  SampleStream(std::shared_ptr<const Job> job, const std::optional<Eigen::Vector3d>& origin);

  /// First a snapshot, then what happened since, and after the end samples, sample mesh and the
  /// last snapshot. Builds at most one chunk.
  Step Next(v1::SampleResponse& message);

  /// OK, or the error the call ends with: what was wrong with the request, CANCELLED, or
  /// UNAVAILABLE when draining stopped the job.
  const absl::Status& end_status() const { return end_status_; }

  std::int64_t samples_written() const { return next_sample_; }

 private:
  bool WriteSnapshot(v1::SampleResponse& message);
  bool WriteReport(v1::SampleResponse& message);
  bool WritePreview(v1::SampleResponse& message);
  bool WriteSamples(v1::SampleResponse& message);
  // Called once the job has ended and its reports are written.
  Step Close(v1::SampleResponse& message);

  const std::shared_ptr<const Job> job_;
  const std::optional<Eigen::Vector3d> origin_;
  std::int64_t seen_version_ = 0;
  std::optional<JobView> ended_;  // The job's last view.
  std::size_t next_report_ = 0;
  std::shared_ptr<const JobPreview> seen_preview_;
  std::int64_t next_sample_ = 0;
  std::int64_t next_triangle_ = 0;
  bool closed_ = false;
  absl::Status end_status_;
};

}  // namespace ccst::server
