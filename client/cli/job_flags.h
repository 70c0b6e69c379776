#pragma once

#include "client/cli/flags.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's.
class App;
}

namespace ccst::cli {

/// The flags of the commands about stored meshes and jobs.
struct JobFlags {
  UploadCommand upload;
  MeshesCommand meshes;
  JobsCommand jobs;
  WatchCommand watch;
  CancelCommand cancel;
  DeleteCommand remove;
  FetchCommand fetch;
};

/// Adds the commands about stored meshes and jobs; both must outlive the app.
void AddJobCommands(CLI::App& app, ServerAddress& server, JobFlags& flags);

/// The one of them that was parsed, without its server; no output may be a file that `server`
/// names. Throws CLI::ValidationError.
Command FinishJobCommand(const CLI::App& app, const ServerAddress& server, JobFlags flags);

}  // namespace ccst::cli
