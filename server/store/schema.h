#pragma once

#include <span>
#include <string>

#include "absl/status/status.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// The scripts that make each version of the schema from the one before: the first makes version 1
/// of an empty database. A script that was released never changes; a new version is a new script.
std::span<const std::string> SchemaMigrations();

/// Brings `database` to the version after the last of `migrations`, each in a transaction.
/// @errors FAILED_PRECONDITION STORAGE_FAILED when it is of a newer version | as Statement
absl::Status MigrateSchema(Database& database, std::span<const std::string> migrations);

}  // namespace ccst::server
