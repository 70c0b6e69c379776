#pragma once

#include <string_view>

#include "absl/status/status.h"

struct sqlite3;

namespace ccst::server {

/// What a system call failed with, as the error callers get: RESOURCE_EXHAUSTED STORAGE_FULL where
/// the disk or the quota is full, RESOURCE_EXHAUSTED QUEUE_FULL where the process has no
/// descriptors or memory just now, else INTERNAL STORAGE_FAILED. `what` says what was tried, as in
/// "cannot write a blob". Names no path, as it may travel to a client.
absl::Status FileError(int error_number, std::string_view what);

/// STORAGE_FULL for what was not even tried.
absl::Status NoSpace(std::string_view what);

/// FileError() for a result code of SQLite; `database` is where it arose and may be null.
absl::Status RecordsError(sqlite3* database, int result_code, std::string_view what);

}  // namespace ccst::server
