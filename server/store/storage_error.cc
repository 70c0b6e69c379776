#include "server/store/storage_error.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <sqlite3.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

bool IsFull(int error_number) { return error_number == ENOSPC || error_number == EDQUOT; }

// What a server has again when calls or connections end.
bool IsShort(int error_number) {
  return error_number == EMFILE || error_number == ENFILE || error_number == ENOMEM ||
         error_number == ENOBUFS || error_number == EAGAIN;
}

absl::Status Failed(std::string_view what, std::string_view why) {
  return MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
                   std::string(what).append(": ").append(why));
}

}  // namespace

absl::Status NoSpace(std::string_view what) {
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kStorageFull,
                   std::string(what) + ": the disk is full");
}

absl::Status FileError(int error_number, std::string_view what) {
  if (IsFull(error_number)) return NoSpace(what);
  std::string why = std::generic_category().message(error_number);
  if (!IsShort(error_number)) return Failed(what, why);
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                   std::string(what).append(": ").append(why).append("; ask again later"));
}

absl::Status RecordsError(sqlite3* database, int result_code, std::string_view what) {
  const int primary = result_code & 0xff;
  // SQLite has a code of its own for a full disk, but not for a full quota or a full disk below the
  // index of its log.
  const bool is_system_error = primary == SQLITE_IOERR || primary == SQLITE_CANTOPEN;
  const int error_number =
      database != nullptr && is_system_error ? sqlite3_system_errno(database) : 0;
  if (primary == SQLITE_FULL || result_code == SQLITE_IOERR_SHMSIZE || IsFull(error_number)) {
    return NoSpace(what);
  }
  if (primary == SQLITE_NOMEM) return FileError(ENOMEM, what);
  if (error_number != 0) return FileError(error_number, what);
  return Failed(what, sqlite3_errstr(result_code));
}

}  // namespace ccst::server
