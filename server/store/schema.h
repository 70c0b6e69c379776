#pragma once

#include <span>

#include "absl/status/status.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// What makes a version of the schema from the one before.
struct Migration {
  const char* script;
  /// After the script, what SQL cannot do; null: nothing.
  absl::Status (*rewrite)(Database&) = nullptr;
};

/// The migrations to each version: the first makes version 1 of an empty database. One that was
/// released never changes; a new version is a new one.
std::span<const Migration> SchemaMigrations();

/// Brings `database` to the version after the last of `migrations`, each in a transaction.
/// @errors FAILED_PRECONDITION STORAGE_FAILED when it is of a newer version | as Statement
absl::Status MigrateSchema(Database& database, std::span<const Migration> migrations);

}  // namespace ccst::server
