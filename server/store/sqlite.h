#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

struct sqlite3;
struct sqlite3_stmt;

namespace ccst::server {

class Database;

/// Bytes for a column of type BLOB; a string_view alone is for one of type TEXT.
struct Bytes {
  std::string_view value;
};

/// One run of an SQL statement: bind all parameters in order, then step. The first error stays and
/// makes the rest do nothing, so it is enough to look at status() in the end.
class Statement {
 public:
  Statement(Statement&&) noexcept = default;
  Statement& operator=(Statement&&) noexcept = default;

  Statement& Bind(std::int64_t value);
  Statement& Bind(bool value) { return Bind(std::int64_t{value}); }
  Statement& Bind(int value) { return Bind(std::int64_t{value}); }
  Statement& Bind(std::string_view value);
  Statement& Bind(const std::string& value) { return Bind(std::string_view(value)); }
  Statement& Bind(const char* value) { return Bind(std::string_view(value)); }
  Statement& Bind(Bytes value);
  Statement& Bind(absl::Time value);                        ///< Microseconds since 1970.
  Statement& Bind(const std::optional<absl::Time>& value);  ///< NULL for none.

  /// Goes to the next row; false when there is none or an error came up.
  bool Next();
  /// Runs a statement that gives no rows.
  absl::Status Run();
  const absl::Status& status() const { return status_; }

  // Columns of the row, from 0.
  std::int64_t Int(int column) const;
  std::string String(int column) const;  ///< Of TEXT or BLOB; empty for NULL.
  absl::Time Time(int column) const;
  std::optional<absl::Time> OptionalTime(int column) const;

 private:
  friend class Database;
  /// Ends a run: a cached statement is made ready for the next, another is freed.
  struct Release {
    bool cached = false;
    void operator()(sqlite3_stmt* statement) const;
  };
  Statement(sqlite3* database, std::unique_ptr<sqlite3_stmt, Release> statement,
            absl::Status status);
  void Check(int result_code);

  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, Release> statement_;
  absl::Status status_;
  int bound_ = 0;
};

/// A connection to an SQLite database file. Not thread-safe.
class Database {
 public:
  /// Opens the file, or makes an empty one that only its owner may read; waits
  /// up to 5 s where another connection holds a lock.
  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED
  static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& path);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// A statement that is prepared once and kept; only one run of it at a time.
  Statement Cached(std::string_view sql);
  /// A statement for this once, such as one whose text depends on the question.
  Statement Once(std::string_view sql);
  /// Runs statements without parameters, separated by semicolons.
  absl::Status RunScript(const std::string& sql);
  /// Whether commits from now on wait until the disk has them, as they do at first; one that does
  /// has all those before it written too. No transaction may be under way.
  absl::Status SetSynchronized(bool synchronized);
  /// Moves all of the log into the database and leaves the log empty; no statement may be under
  /// way.
  absl::Status Checkpoint();

 private:
  friend class Transaction;
  Database() = default;
  Statement Prepare(std::string_view sql, bool cached);

  sqlite3* handle_ = nullptr;
  std::map<std::string, sqlite3_stmt*, std::less<>> cache_;
};

/// Makes several changes one: all of them are there after Commit(), none without.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  /// Whether it has begun.
  const absl::Status& status() const { return status_; }
  absl::Status Commit();

 private:
  Database& database_;
  absl::Status status_;
};

}  // namespace ccst::server
