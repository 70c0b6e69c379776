#pragma once

#include <cstdint>
#include <string>

#include "server/store/page_token.h"
#include "server/store/records.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// The query for at most `limit` jobs that `filter` keeps, newest first from behind `key`. It walks
/// the index of the most selective thing asked for (a label, the mesh, the owner) in the order of
/// the list, so it stops as soon as the page is full.
/// `columns` say `jobs.` where the labels have such a column too.
Statement JobListQuery(Database& database, const std::string& columns, const JobFilter& filter,
                       const PageKey& key, std::int64_t limit);

}  // namespace ccst::server
