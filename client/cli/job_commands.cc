#include <cstdio>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/listing.h"
#include "client/lib/client.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"

namespace ccst::cli {
namespace {

absl::StatusOr<std::vector<v1::Job>> List(const JobsCommand& command) {
  std::vector<v1::Job::State> states;
  for (const std::string& state : command.states) {
    if (const auto known = StateFromName(state)) states.push_back(*known);
  }
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  return client.ListJobs(states, command.labels);
}

absl::StatusOr<v1::Job> Cancel(const CancelCommand& command) {
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  return client.CancelJob(command.job);
}

absl::Status Delete(const DeleteCommand& command) {
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  return absl::StartsWith(command.name, "meshes/") ? client.DeleteMesh(command.name)
                                                   : client.DeleteJob(command.name);
}

ExitCode Fail(const absl::Status& status, const std::string& server) {
  PrintError(status, server);
  return ExitCodeFor(status);
}

}  // namespace

ExitCode Run(const JobsCommand& command) {
  const auto jobs = List(command);
  if (!jobs.ok()) return Fail(jobs.status(), command.server);
  std::fputs((command.json ? JobsJson(*jobs) : JobsText(*jobs)).c_str(), stdout);
  return kOk;
}

ExitCode Run(const CancelCommand& command) {
  const auto job = Cancel(command);
  if (!job.ok()) return Fail(job.status(), command.server);
  std::fprintf(stderr, "%s: %s\n", PrintableText(job->name()).c_str(),
               StateName(job->state()).c_str());
  return kOk;
}

ExitCode Run(const DeleteCommand& command) {
  const absl::Status status = Delete(command);
  return status.ok() ? kOk : Fail(status, command.server);
}

}  // namespace ccst::cli
