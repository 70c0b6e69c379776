#include "client/cli/listing.h"

#include <algorithm>
#include <array>
#include <utility>

#include <google/protobuf/util/time_util.h>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/flags.h"
#include "client/cli/json_text.h"
#include "core/base/printable_text.h"
#include "proto/convert/enums.h"

namespace ccst::cli {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<std::string>;

constexpr std::size_t kMaxCellBytes = 512;

constexpr std::array<std::pair<v1::Job::State, const char*>, 6> kStates = {
    {{v1::Job::STATE_QUEUED, "queued"},
     {v1::Job::STATE_RUNNING, "running"},
     {v1::Job::STATE_CANCELLING, "cancelling"},
     {v1::Job::STATE_SUCCEEDED, "succeeded"},
     {v1::Job::STATE_FAILED, "failed"},
     {v1::Job::STATE_CANCELLED, "cancelled"}}};

// Columns as wide as their widest cell; the last one is not padded. Cells hold what others chose:
// they are kept on one line, off the terminal's controls, and at a length that names have.
std::string Table(std::vector<Row> rows) {
  for (Row& row : rows) {
    for (std::string& cell : row) cell = PrintableExcerpt(cell, kMaxCellBytes);
  }
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool is_last = i + 1 == row.size();
      absl::StrAppend(&text, row[i],
                      is_last ? "\n" : std::string(widths[i] - row[i].size() + 2, ' '));
    }
  }
  return text;
}

// In UTC, to the second.
std::string Time(const google::protobuf::Timestamp& time) {
  google::protobuf::Timestamp rounded = time;
  rounded.set_nanos(0);
  return google::protobuf::util::TimeUtil::ToString(rounded);
}

Json TimeOrNull(bool has, const google::protobuf::Timestamp& time) {
  return has ? Json(google::protobuf::util::TimeUtil::ToString(time)) : Json(nullptr);
}

std::string Method(v1::SamplingMethod method) {
  const auto known = FromProto(method);
  return known.has_value() ? MethodName(*known) : "unknown";
}

// How far it is, or how it ended.
std::string Note(const v1::Job& job) {
  switch (job.state()) {
    case v1::Job::STATE_QUEUED:
      return absl::StrCat(job.queue_position(), " ahead");
    case v1::Job::STATE_RUNNING:
    case v1::Job::STATE_CANCELLING:
      return absl::StrCat("alternation ", job.progress().iteration());
    case v1::Job::STATE_SUCCEEDED:
      return absl::StrCat(job.result_cached() ? "cached, " : "", job.result().iteration_count(),
                          " alternations");
    case v1::Job::STATE_FAILED:
      return job.error().message();
    default:
      return "";
  }
}

Json JobJson(const v1::Job& job) {
  Json json;
  json["name"] = job.name();
  json["display_name"] = job.display_name();
  json["state"] = StateName(job.state());
  json["mesh"] = job.mesh();
  json["count"] = job.effective_options().sample_count();
  json["seed"] = job.effective_options().seed();
  json["method"] = Method(job.effective_options().method());
  json["queue_position"] = job.queue_position();
  json["iteration"] = job.has_progress() ? Json(job.progress().iteration()) : Json(nullptr);
  json["capacity_cv"] = job.has_result() ? Json(job.result().capacity_cv()) : Json(nullptr);
  json["samples_digest"] =
      job.has_result() ? Json(job.result().samples_digest().sha256()) : Json(nullptr);
  json["cached"] = job.result_cached();
  json["error"] = job.has_error() ? Json(job.error().message()) : Json(nullptr);
  json["create_time"] = TimeOrNull(job.has_create_time(), job.create_time());
  json["start_time"] = TimeOrNull(job.has_start_time(), job.start_time());
  json["end_time"] = TimeOrNull(job.has_end_time(), job.end_time());
  json["expire_time"] = TimeOrNull(job.has_expire_time(), job.expire_time());
  json["labels"] = Json::object();
  for (const auto& [key, value] : job.labels()) json["labels"][key] = value;
  return json;
}

Json MeshJson(const v1::Mesh& mesh) {
  Json json;
  json["name"] = mesh.name();
  json["display_name"] = mesh.display_name();
  json["bytes"] = mesh.digest().size_bytes();
  json["vertices"] = mesh.vertex_count();
  json["faces"] = mesh.face_count();
  json["components"] = mesh.component_count();
  json["boundary_loops"] = mesh.boundary_loop_count();
  json["area"] = mesh.surface_area();
  json["attributes"] = Json::array();
  for (const auto& attribute : mesh.attributes()) {
    json["attributes"].push_back(attribute.attribute_name());
  }
  json["warnings"] = Json(std::vector<std::string>(mesh.warnings().begin(), mesh.warnings().end()));
  json["create_time"] = TimeOrNull(mesh.has_create_time(), mesh.create_time());
  json["expire_time"] = TimeOrNull(mesh.has_expire_time(), mesh.expire_time());
  return json;
}

}  // namespace

std::string StateName(v1::Job::State state) {
  for (const auto& [value, name] : kStates) {
    if (value == state) return name;
  }
  return "unknown";
}

std::optional<v1::Job::State> StateFromName(std::string_view name) {
  for (const auto& [value, known] : kStates) {
    if (name == known) return value;
  }
  return std::nullopt;
}

std::string JobsText(const std::vector<v1::Job>& jobs) {
  std::vector<Row> rows = {{"JOB", "STATE", "SAMPLES", "CREATED", "NAME", "NOTE"}};
  for (const v1::Job& job : jobs) {
    rows.push_back({job.name(), StateName(job.state()),
                    absl::StrCat(job.effective_options().sample_count()), Time(job.create_time()),
                    job.display_name(), Note(job)});
  }
  return Table(std::move(rows));
}

std::string MeshesText(const std::vector<v1::Mesh>& meshes) {
  std::vector<Row> rows = {{"MESH", "BYTES", "FACES", "CREATED", "NAME"}};
  for (const v1::Mesh& mesh : meshes) {
    rows.push_back({mesh.name(), absl::StrCat(mesh.digest().size_bytes()),
                    absl::StrCat(mesh.face_count()), Time(mesh.create_time()),
                    mesh.display_name()});
  }
  return Table(std::move(rows));
}

std::string JobsJson(const std::vector<v1::Job>& jobs) {
  Json json = Json::array();
  for (const v1::Job& job : jobs) json.push_back(JobJson(job));
  return JsonText(json);
}

std::string MeshesJson(const std::vector<v1::Mesh>& meshes) {
  Json json = Json::array();
  for (const v1::Mesh& mesh : meshes) json.push_back(MeshJson(mesh));
  return JsonText(json);
}

}  // namespace ccst::cli
