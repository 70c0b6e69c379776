#include "server/store/storage_error.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <sqlite3.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

bool IsFull(int error_number) { return error_number == ENOSPC || error_number == EDQUOT; }

absl::Status Full(std::string_view what) {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kStorageFull,
                   std::string(what) + ": the disk is full");
}

absl::Status Failed(std::string_view what, std::string_view why) {
  return MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
                   std::string(what).append(": ").append(why));
}

}  // namespace

absl::Status FileError(int error_number, std::string_view what) {
  if (IsFull(error_number)) return Full(what);
  return Failed(what, std::generic_category().message(error_number));
}

absl::Status RecordsError(sqlite3* database, int result_code, std::string_view what) {
  const int primary = result_code & 0xff;
  // SQLite has a code of its own for a full disk, but not for a full quota or a full disk below the
  // index of its log.
  const bool is_system_error = primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN;
  const int error_number =
      database != nullptr && is_system_error ? sqlite3_system_errno(database) : 0;
  if (primary == SQLITE_FULL || result_code == SQLITE_IOERR_SHMSIZE || IsFull(error_number)) {
    return Full(what);
  }
  if (error_number != 0) return FileError(error_number, what);
  return Failed(what, sqlite3_errstr(result_code));
}

}  // namespace ccst::server
