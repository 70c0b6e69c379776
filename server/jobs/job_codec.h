#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/jobs/job.h"

namespace ccst::server {

/// How what a store keeps of a job is written down; the store takes it for opaque bytes.
struct JobCodec {
  /// Options, origin and what else of the spec has no column of its own.
  std::function<std::string(const JobSpec&)> encode_definition;
  std::function<absl::Status(const std::string&, JobSpec&)> decode_definition;
  /// Result or error, and why it stopped.
  std::function<std::string(const JobView&)> encode_outcome;
  std::function<absl::Status(const std::string&, JobView&)> decode_outcome;
  /// All reports.
  std::function<std::string(std::span<const AlternationReport>)> encode_history;
  std::function<absl::StatusOr<std::vector<AlternationReport>>(const std::string&)> decode_history;
};

}  // namespace ccst::server
