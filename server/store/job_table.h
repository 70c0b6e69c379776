#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/store/records.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// The jobs of an embedded store, with their labels and histories. The methods are those of Store;
/// not thread-safe.
class JobTable {
 public:
  explicit JobTable(Database& database) : database_(database) {}

  /// With its history, unless that is empty.
  absl::StatusOr<JobRecord> Add(const JobRecord& job, const std::string& history);
  absl::Status MarkCancelling(const std::string& id);
  absl::Status AddToStarts(const std::string& id, int change);
  absl::Status End(const JobRecord& job, const std::string& history);
  absl::StatusOr<std::optional<JobRecord>> Get(const std::string& id);
  absl::StatusOr<std::optional<JobRecord>> FindRequest(const std::string& owner,
                                                       const std::string& request_id);
  absl::StatusOr<std::string> GetHistory(const std::string& id);
  absl::StatusOr<Page<JobRecord>> List(const JobFilter& filter, int page_size,
                                       const std::string& page_token);
  absl::StatusOr<std::vector<JobRecord>> Unfinished();
  absl::StatusOr<std::optional<JobRecord>> FindReusable(const std::string& spec_digest,
                                                        absl::Time now);
  absl::Status Delete(const std::string& id);
  absl::StatusOr<std::vector<DroppedJob>> DropExpired(absl::Time now, int limit);
  absl::StatusOr<bool> RefersTo(const std::string& sha256);

 private:
  // Its digest; empty for none.
  absl::StatusOr<std::string> PutHistory(const std::string& history);

  Database& database_;
};

}  // namespace ccst::server
