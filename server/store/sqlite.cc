#include "server/store/sqlite.h"

#include <utility>

#include <sqlite3.h>

#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

constexpr int kBusyMilliseconds = 5000;
constexpr char kFailure[] = "cannot read or write the records";

}  // namespace

void Statement::Release::operator()(sqlite3_stmt* statement) const {
  if (!cached) {
    sqlite3_finalize(statement);
    return;
  }
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
}

Statement::Statement(sqlite3* database, std::unique_ptr<sqlite3_stmt, Release> statement,
                     absl::Status status)
    : database_(database), statement_(std::move(statement)), status_(std::move(status)) {}

void Statement::Check(int result_code) {
  if (result_code != SQLITE_OK) status_ = RecordsError(database_, result_code, kFailure);
}

Statement& Statement::Bind(std::int64_t value) {
  if (status_.ok()) Check(sqlite3_bind_int64(statement_.get(), ++bound_, value));
  return *this;
}

Statement& Statement::Bind(std::string_view value) {
  if (status_.ok()) {
    // A null pointer would bind NULL.
    Check(sqlite3_bind_text64(statement_.get(), ++bound_, value.empty() ? "" : value.data(),
                              value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  }
  return *this;
}

Statement& Statement::Bind(Bytes value) {
  if (status_.ok()) {
    Check(sqlite3_bind_blob64(statement_.get(), ++bound_,
                              value.value.empty() ? "" : value.value.data(), value.value.size(),
                              SQLITE_TRANSIENT));
  }
  return *this;
}

Statement& Statement::Bind(absl::Time value) { return Bind(absl::ToUnixMicros(value)); }

Statement& Statement::Bind(const std::optional<absl::Time>& value) {
  if (value.has_value()) return Bind(*value);
  if (status_.ok()) Check(sqlite3_bind_null(statement_.get(), ++bound_));
  return *this;
}

bool Statement::Next() {
  if (!status_.ok()) return false;
  const int result_code = sqlite3_step(statement_.get());
  if (result_code == SQLITE_ROW) return true;
  if (result_code != SQLITE_DONE) Check(result_code);
  return false;
}

absl::Status Statement::Run() {
  Next();
  return status_;
}

std::int64_t Statement::Int(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

std::string Statement::String(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return size == 0 ? "" : std::string(static_cast<const char*>(bytes), size);
}

absl::Time Statement::Time(int column) const { return absl::FromUnixMicros(Int(column)); }

std::optional<absl::Time> Statement::OptionalTime(int column) const {
  if (sqlite3_column_type(statement_.get(), column) == SQLITE_NULL) return std::nullopt;
  return Time(column);
}

absl::StatusOr<std::unique_ptr<Database>> Database::Open(const std::string& path) {
  std::unique_ptr<Database> database(new Database());
  // The caller's lock makes SQLite's own one superfluous.
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  const int result_code = sqlite3_open_v2(path.c_str(), &database->handle_, flags, nullptr);
  if (result_code != SQLITE_OK) {
    return RecordsError(database->handle_, result_code, "cannot open the records");
  }
  sqlite3_extended_result_codes(database->handle_, 1);
  sqlite3_busy_timeout(database->handle_, kBusyMilliseconds);
  return database;
}

Database::~Database() {
  for (const auto& [sql, statement] : cache_) sqlite3_finalize(statement);
  sqlite3_close(handle_);
}

Statement Database::Prepare(std::string_view sql, bool cached) {
  sqlite3_stmt* statement = nullptr;
  const int result_code =
      sqlite3_prepare_v3(handle_, sql.data(), static_cast<int>(sql.size()),
                         cached ? SQLITE_PREPARE_PERSISTENT : 0, &statement, nullptr);
  absl::Status status =
      result_code == SQLITE_OK ? absl::OkStatus() : RecordsError(handle_, result_code, kFailure);
  return Statement(
      handle_,
      std::unique_ptr<sqlite3_stmt, Statement::Release>(statement, Statement::Release{cached}),
      std::move(status));
}

Statement Database::Cached(std::string_view sql) {
  if (const auto found = cache_.find(sql); found != cache_.end()) {
    return Statement(
        handle_,
        std::unique_ptr<sqlite3_stmt, Statement::Release>(found->second, Statement::Release{true}),
        absl::OkStatus());
  }
  Statement statement = Prepare(sql, true);
  if (statement.status().ok()) cache_.emplace(sql, statement.statement_.get());
  return statement;
}

Statement Database::Once(std::string_view sql) { return Prepare(sql, false); }

absl::Status Database::RunScript(const std::string& sql) {
  const int result_code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  return result_code == SQLITE_OK ? absl::OkStatus() : RecordsError(handle_, result_code, kFailure);
}

absl::Status Database::SetSynchronized(bool synchronized) {
  return RunScript(synchronized ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL");
}

absl::Status Database::Checkpoint() {
  const int result_code =
      sqlite3_wal_checkpoint_v2(handle_, nullptr, SQLITE_CHECKPOINT_TRUNCATE, nullptr, nullptr);
  return result_code == SQLITE_OK ? absl::OkStatus() : RecordsError(handle_, result_code, kFailure);
}

Transaction::Transaction(Database& database)
    : database_(database), status_(database.Cached("BEGIN IMMEDIATE").Run()) {}

Transaction::~Transaction() {
  // SQLite may have rolled back by itself after an error.
  if (status_.ok() && sqlite3_get_autocommit(database_.handle_) == 0) {
    sqlite3_exec(database_.handle_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

absl::Status Transaction::Commit() { return database_.Cached("COMMIT").Run(); }

}  // namespace ccst::server
