#pragma once

#include "absl/status/status.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// Rewrites what jobs and meshes of version 4 of the schema carry in the formats of version 5
/// (server/formats/earlier_formats.h), within the transaction of the caller. What is damaged stays
/// as it is, and is found damaged by whoever reads it. Takes about 0.1 ms a record, and the space
/// of all of them until the transaction is over.
absl::Status UpgradeRecords(Database& database);

}  // namespace ccst::server
