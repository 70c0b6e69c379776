#pragma once

#include <string_view>

#include "absl/status/status.h"

struct sqlite3;

namespace ccst::server {

/// What a system call failed with, as the error callers get: RESOURCE_EXHAUSTED STORAGE_FULL where
/// the disk or the quota is full, else INTERNAL STORAGE_FAILED. `what` says what was tried, as in
/// "cannot write a blob". Names no path, as it may travel to a client.
absl::Status FileError(int error_number, std::string_view what);

/// The same for a result code of SQLite; `database` is where it arose and may be null.
absl::Status RecordsError(sqlite3* database, int result_code, std::string_view what);

}  // namespace ccst::server
