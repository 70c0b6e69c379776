#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/sampling/result.h"
#include "core/sampling/run_control.h"

namespace ccst::server {

/// What came out of a whole run: its figures. The samples are a blob of their own.
struct JobResult {
  SamplingResult run;  ///< `samples` empty.
  std::int64_t sample_count = 0;
  std::int64_t triangle_count = 0;
  std::string samples_sha256;      ///< Of the layout of proto/docs/samples.md.
  std::int64_t samples_bytes = 0;  ///< Length of what that digest is of.
  double queue_seconds = 0.0;
  double decode_seconds = 0.0;
  double total_seconds = 0.0;  ///< Decoding and the run.
  std::vector<std::string> warnings;
};

/// How a job ended, apart from what its record has columns for: state, times, samples.
struct JobOutcome {
  std::shared_ptr<const JobResult> result;  ///< Set when it succeeded.
  absl::Status error;                       ///< Not OK when it failed.
  std::optional<Phase> phase;               ///< Empty where no worker took it.
  std::optional<AlternationReport> last_report;
};

/// As bytes of a ccst.store.v1.Outcome. An error keeps its code, message, reason and limit.
std::string EncodeOutcome(const JobOutcome& outcome);
/// The reverse; no bytes are the outcome of a job that has not ended, in which nothing is set.
/// @errors DATA_LOSS STORAGE_FAILED the bytes are none
absl::StatusOr<JobOutcome> DecodeOutcome(const std::string& bytes);

}  // namespace ccst::server
