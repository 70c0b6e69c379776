#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/time/time.h"

namespace ccst::server {

/// Life of a job. Ended states never change.
enum class JobState { kQueued, kRunning, kCancelling, kSucceeded, kFailed, kCancelled };

/// True for SUCCEEDED, FAILED and CANCELLED.
bool HasEnded(JobState state);

/// A mesh as one owner sees it; its bytes are a blob. Times have microseconds.
struct MeshRecord {
  std::string owner;
  std::string sha256;
  std::int64_t size_bytes = 0;
  std::string display_name;
  absl::Time create_time;
  absl::Time expire_time;
  std::string facts;     ///< Opaque to the store.
  bool damaged = false;  ///< When read: something but `expire_time` is not what was stored.
};

/// A job as it is stored. RUNNING is never stored: whatever runs when the server goes away is
/// queued when it comes back. Times have microseconds.
struct JobRecord {
  std::string id;  ///< UUID.
  std::string owner;
  std::string request_id;  ///< Unique among the owner's; empty: none.
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::string mesh_sha256;
  std::string texture_sha256;  ///< Empty: none.
  std::string spec_digest;     ///< Equal specs have equal ones.
  std::string definition;      ///< Options and the rest of the request; opaque to the store.
  JobState state = JobState::kQueued;
  absl::Time create_time;
  std::optional<absl::Time> start_time;
  std::optional<absl::Time> end_time;
  std::optional<absl::Time> expire_time;  ///< Set when it has ended.
  std::string outcome;                    ///< Figures or error; opaque; empty before the end.
  std::string samples_sha256;             ///< The blob with the samples; empty: none.
  bool reusable = false;                  ///< The result may answer an equal spec.
  bool cached = false;                    ///< The result was taken from an equal spec.
  bool damaged = false;                   ///< When read: something is not what was stored.
  int starts = 0;  ///< Runs that began and were neither ended nor given back.
  /// When added: what its end may add, outcome and history; counts until it ends.
  std::int64_t expected_end_bytes = 0;
  /// When added: a loss of power before its end, or another durable change, may take it away, so
  /// that nobody waits for the disk. The loss of the process does not.
  bool may_be_lost = false;
};

/// A job that was dropped.
struct DroppedJob {
  std::string id;
  std::vector<std::string> blobs;  ///< That it referred to: samples, texture, mesh.
};

/// Which jobs to list. An empty field keeps all.
struct JobFilter {
  std::optional<std::string> owner;
  std::vector<JobState> states;  ///< RUNNING stands for QUEUED, as which it is stored.
  std::string mesh_sha256;
  std::map<std::string, std::string> labels;  ///< All of them.
};

/// One page of a list, newest first.
template <typename Record>
struct Page {
  std::vector<Record> records;
  std::string next_token;  ///< Empty on the last page.
};

}  // namespace ccst::server
