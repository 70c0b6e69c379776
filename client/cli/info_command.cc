#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/json_text.h"
#include "client/lib/client.h"
#include "core/base/printable_text.h"
#include "proto/convert/scalars.h"

namespace ccst::cli {
namespace {

std::string InfoJson(const std::string& server, const v1::GetServerInfoResponse& info) {
  const v1::ServerLimits& limits = info.limits();
  nlohmann::ordered_json json;
  json["server"] = server;
  json["version"] = info.server_version();
  json["revision"] = info.source_revision();
  json["algorithm_revision"] = info.algorithm_revision();
  json["limits"] = {{"max_inline_mesh_bytes", limits.max_inline_mesh_bytes()},
                    {"max_texture_bytes", limits.max_texture_bytes()},
                    {"max_vertex_count", limits.max_vertex_count()},
                    {"max_face_count", limits.max_face_count()},
                    {"max_sample_count", limits.max_sample_count()},
                    {"max_iterations", limits.max_iterations()},
                    {"max_queued_jobs", limits.max_queued_jobs()},
                    {"max_running_jobs", limits.max_running_jobs()},
                    {"max_job_duration", SecondsFromProto(limits.max_job_duration())}};
  json["load"] = {{"queued_jobs", info.load().queued_job_count()},
                  {"running_jobs", info.load().running_job_count()}};
  return JsonText(json);
}

std::string InfoText(const std::string& server, const v1::GetServerInfoResponse& info) {
  const v1::ServerLimits& limits = info.limits();
  return absl::StrFormat(
      "server      %s\n"
      "version     %s (%s), algorithm revision %d\n"
      "mesh        at most %d bytes encoded, %d vertices, %d faces\n"
      "job         at most %d samples, %d alternations, %g s\n"
      "load        %d running of %d, %d waiting of %d\n",
      PrintableText(server), PrintableText(info.server_version()),
      PrintableText(info.source_revision()), info.algorithm_revision(),
      limits.max_inline_mesh_bytes(), limits.max_vertex_count(), limits.max_face_count(),
      limits.max_sample_count(), limits.max_iterations(),
      SecondsFromProto(limits.max_job_duration()), info.load().running_job_count(),
      limits.max_running_jobs(), info.load().queued_job_count(), limits.max_queued_jobs());
}

}  // namespace

ExitCode Run(const InfoCommand& command) {
  auto client = ConnectTo(command.server, command.server_flags);
  if (!client.ok()) {
    PrintError(client.status(), command.server);
    return ExitCodeFor(client.status());
  }
  const auto info = client->GetServerInfo();
  if (!info.ok()) {
    PrintError(info.status(), command.server);
    return ExitCodeFor(info.status());
  }
  const std::string text =
      command.json ? InfoJson(command.server, *info) : InfoText(command.server, *info);
  std::fputs(text.c_str(), stdout);
  return kOk;
}

}  // namespace ccst::cli
