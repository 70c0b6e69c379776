#pragma once

#include <cstdint>
#include <string_view>

#include "server/store/page_token.h"
#include "server/store/records.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// The query for at most `limit` jobs that `filter` keeps, newest first from behind `key`. It walks
/// the index of the most selective thing asked for (a label, the mesh, the owner) in the order of
/// the list, so it stops as soon as the page is full.
Statement JobListQuery(Database& database, std::string_view columns, const JobFilter& filter,
                       const PageKey& key, std::int64_t limit);

}  // namespace ccst::server
