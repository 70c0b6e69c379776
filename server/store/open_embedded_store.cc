#include <cerrno>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "server/store/embedded_store.h"
#include "server/store/file_blobs.h"
#include "server/store/files.h"
#include "server/store/schema.h"
#include "server/store/space_reserve.h"
#include "server/store/sqlite.h"
#include "server/store/storage_error.h"
#include "server/store/store.h"

namespace ccst::server {
namespace {

constexpr char kLockName[] = "lock";
constexpr char kRecordsName[] = "records.sqlite";

// A write-ahead log that is synchronized at every commit: what was committed survives a loss of
// power. The log is cut back after a burst. SQLite's usual cache of 2 MiB suffices: what it
// lacks comes from the operating system's, a few milliseconds for a walk through 100,000 jobs.
constexpr char kSettings[] =
    "PRAGMA journal_mode = WAL;"
    "PRAGMA synchronous = FULL;"
    "PRAGMA journal_size_limit = 67108864;"
    "PRAGMA foreign_keys = ON;"
    "PRAGMA trusted_schema = OFF;"
    "PRAGMA cell_size_check = ON;"
    "PRAGMA temp_store = MEMORY;";

absl::Status CheckPages(Database& database) {
  Statement statement = database.Once("PRAGMA quick_check(1)");
  if (statement.Next() && statement.String(0) == "ok") return absl::OkStatus();
  CCST_RETURN_IF_ERROR(statement.status());
  return MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
                   absl::StrCat("the records are damaged: ", statement.String(0)));
}

// Looks at every page. Mapped, as the file is read with the disk's speed then and not with that of
// single pages, 0.5 s instead of 10 for 100 MB; only for this, as a disk that fails below a mapping
// kills the process.
absl::Status CheckRecords(Database& database) {
  CCST_RETURN_IF_ERROR(database.RunScript("PRAGMA mmap_size = 2147418112"));
  const absl::Status status = CheckPages(database);
  CCST_RETURN_IF_ERROR(database.RunScript("PRAGMA mmap_size = 0"));
  return status;
}

absl::StatusOr<std::unique_ptr<Database>> OpenRecords(const FileDescriptor& directory,
                                                      const std::string& path) {
  // SQLite would let the group and others read what it makes; its further files follow this one.
  const FileDescriptor file(
      openat(directory.number(), kRecordsName, O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open()) return FileError(errno, "cannot open the records");
  CCST_RETURN_IF_ERROR(Synchronize(directory, "cannot make the records"));
  std::unique_ptr<Database> database;
  CCST_ASSIGN_OR_RETURN(database, Database::Open(absl::StrCat(path, "/", kRecordsName)));
  CCST_RETURN_IF_ERROR(database->RunScript(kSettings));
  CCST_RETURN_IF_ERROR(CheckRecords(*database));
  absl::Status migrated = MigrateSchema(*database, SchemaMigrations());
  // A damaged index keeps rows from being rewritten.
  if (absl::IsInternal(migrated) && database->RunScript("REINDEX").ok()) {
    migrated = MigrateSchema(*database, SchemaMigrations());
  }
  CCST_RETURN_IF_ERROR(migrated);
  return database;
}

// Blobs whose record was not written any more before the process went away, or whose removal did
// not come after that of the record. Nothing else is writing yet.
absl::Status RemoveUnreferencedBlobs(Store& store) {
  std::vector<std::string> digests;
  CCST_ASSIGN_OR_RETURN(digests, store.blobs().List());
  for (const std::string& sha256 : digests) {
    bool is_referenced = false;
    CCST_ASSIGN_OR_RETURN(is_referenced, store.IsReferenced(sha256));
    if (!is_referenced) CCST_RETURN_IF_ERROR(store.blobs().Remove(sha256));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<Store>> OpenIn(const std::string& path,
                                              std::int64_t max_blob_bytes) {
  FileDescriptor directory;
  CCST_ASSIGN_OR_RETURN(directory, OpenDirectory(path));
  FileDescriptor lock;
  CCST_ASSIGN_OR_RETURN(lock, LockFile(directory, kLockName));
  std::unique_ptr<SpaceReserve> reserve;
  CCST_ASSIGN_OR_RETURN(reserve, SpaceReserve::Open(directory));
  auto database = OpenRecords(directory, path);
  if (GetErrorReason(database.status()) == ErrorReason::kStorageFull) {
    // On a full disk, which can only be emptied by a server that has opened its records.
    reserve->GiveUp();
    database = OpenRecords(directory, path);
  }
  CCST_RETURN_IF_ERROR(database.status());
  std::unique_ptr<FileBlobs> blobs;
  CCST_ASSIGN_OR_RETURN(blobs, FileBlobs::Open(directory, max_blob_bytes, reserve.get()));
  auto store = std::make_unique<EmbeddedStore>(std::move(lock), std::move(reserve),
                                               std::move(blobs), *std::move(database));
  CCST_RETURN_IF_ERROR(RemoveUnreferencedBlobs(*store));
  return store;
}

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> OpenEmbeddedStore(const std::string& directory,
                                                         std::int64_t max_blob_bytes) {
  absl::StatusOr<std::unique_ptr<Store>> store = OpenIn(directory, max_blob_bytes);
  if (store.ok()) return store;
  return MakeError(store.status().code(),
                   GetErrorReason(store.status()).value_or(ErrorReason::kStorageFailed),
                   absl::StrCat("the store in ", directory, ": ", store.status().message()));
}

}  // namespace ccst::server
