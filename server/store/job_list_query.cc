#include "server/store/job_list_query.h"

#include <initializer_list>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/store/job_state_name.h"

namespace ccst::server {
namespace {

// The conditions of a query and the texts to bind to them, in order.
struct Conditions {
  void Add(std::string_view condition, std::initializer_list<std::string_view> values) {
    sql.append(" AND ").append(condition);
    texts.insert(texts.end(), values.begin(), values.end());
  }

  std::string sql;
  std::vector<std::string_view> texts;
};

}  // namespace

Statement JobListQuery(Database& database, const std::string& columns, const JobFilter& filter,
                       const PageKey& key, std::int64_t limit) {
  // CROSS JOIN and INDEXED BY hold SQLite to the walk: it would guess, as it does not know how
  // often a value occurs.
  std::string source = "jobs INDEXED BY jobs_list";
  std::string walked = "jobs";
  std::string id = "jobs.id";
  Conditions conditions;
  if (!filter.labels.empty()) {
    source =
        "job_labels INDEXED BY job_labels_list"
        " CROSS JOIN jobs INDEXED BY jobs_state ON jobs.id = job_labels.job_id";
    walked = "job_labels";
    id = "job_labels.job_id";
    auto label = filter.labels.begin();
    conditions.Add("job_labels.name = ? AND job_labels.value = ?", {label->first, label->second});
    for (++label; label != filter.labels.end(); ++label) {
      conditions.Add(
          "EXISTS (SELECT 1 FROM job_labels AS other WHERE other.job_id = job_labels.job_id"
          " AND other.name = ? AND other.value = ?)",
          {label->first, label->second});
    }
  } else if (!filter.mesh_sha256.empty()) {
    source += "_mesh";
  } else if (filter.owner.has_value()) {
    source += "_owner";
  }
  if (!filter.mesh_sha256.empty()) {
    conditions.Add(walked + ".mesh_sha256 = ?", {filter.mesh_sha256});
  }
  if (filter.owner.has_value()) conditions.Add(walked + ".owner = ?", {*filter.owner});
  if (!filter.states.empty()) {
    conditions.Add(
        absl::StrCat("jobs.state IN (",
                     absl::StrJoin(std::vector<std::string>(filter.states.size(), "?"), ", "), ")"),
        {});
    for (const JobState state : filter.states) conditions.texts.push_back(JobStateName(state));
  }

  const std::string sql = absl::StrCat(
      "SELECT ", columns, " FROM ", source, " WHERE (", walked, ".create_time, ", id, ") < (?, ?)",
      conditions.sql, " ORDER BY ", walked, ".create_time DESC, ", id, " DESC LIMIT ?");
  Statement statement = database.Once(sql);
  statement.Bind(key.create_time).Bind(key.id);
  for (const std::string_view text : conditions.texts) statement.Bind(text);
  statement.Bind(limit);
  return statement;
}

}  // namespace ccst::server
