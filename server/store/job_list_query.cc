#include "server/store/job_list_query.h"

#include <initializer_list>
#include <string>
#include <vector>

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

Statement JobListQuery(Database& database, std::string_view columns, const JobFilter& filter,
                       const PageKey& key, std::int64_t limit) {
  // CROSS JOIN and INDEXED BY hold SQLite to the walk: it would guess, as it does not know how
  // often a value occurs.
  std::string_view source = " FROM jobs INDEXED BY jobs_list";
  std::string_view time_and_id = "jobs.create_time DESC, jobs.id DESC";
  std::string_view behind_key = "(jobs.create_time, jobs.id) < (?, ?)";
  auto label = filter.labels.begin();
  Conditions conditions;
  if (label != filter.labels.end()) {
    source =
        " FROM job_labels AS walked INDEXED BY job_labels_list"
        " CROSS JOIN jobs ON jobs.id = walked.job_id";
    time_and_id = "walked.create_time DESC, walked.job_id DESC";
    behind_key = "(walked.create_time, walked.job_id) < (?, ?)";
    conditions.Add("walked.name = ? AND walked.value = ?", {label->first, label->second});
    if (filter.owner.has_value()) conditions.Add("walked.owner = ?", {*filter.owner});
    for (++label; label != filter.labels.end(); ++label) {
      conditions.Add(
          "EXISTS (SELECT 1 FROM job_labels AS other WHERE other.job_id = walked.job_id"
          " AND other.name = ? AND other.value = ?)",
          {label->first, label->second});
    }
  } else if (!filter.mesh_sha256.empty()) {
    source = " FROM jobs INDEXED BY jobs_list_mesh";
  } else if (filter.owner.has_value()) {
    source = " FROM jobs INDEXED BY jobs_list_owner";
  }
  if (!filter.mesh_sha256.empty()) conditions.Add("jobs.mesh_sha256 = ?", {filter.mesh_sha256});
  if (filter.owner.has_value()) conditions.Add("jobs.owner = ?", {*filter.owner});
  if (!filter.states.empty()) {
    std::string_view separator = "jobs.state IN (?";
    conditions.sql += " AND ";
    for (const JobState state : filter.states) {
      conditions.sql += separator;
      conditions.texts.push_back(JobStateName(state));
      separator = ", ?";
    }
    conditions.sql += ")";
  }

  std::string sql = "SELECT ";
  sql.append(columns).append(source).append(" WHERE ").append(behind_key).append(conditions.sql);
  sql.append(" ORDER BY ").append(time_and_id).append(" LIMIT ?");
  Statement statement = database.Once(sql);
  statement.Bind(key.create_time).Bind(key.id);
  for (const std::string_view text : conditions.texts) statement.Bind(text);
  statement.Bind(limit);
  return statement;
}

}  // namespace ccst::server
