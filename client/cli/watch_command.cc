#include <cstdio>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/interrupt.h"
#include "client/cli/progress.h"
#include "client/lib/checked_outcome.h"
#include "client/lib/client.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"

namespace ccst::cli {
namespace {

// OK when the job succeeded.
absl::Status Watch(const WatchCommand& command, ProgressPrinter& printer,
                   const std::stop_token& stop) {
  WatchOptions options;
  options.callbacks = CallbacksThatShow(printer);
  options.patience_seconds = command.patience_seconds;
  options.on_lost = [&printer](const absl::Status& status) {
    printer.Note(absl::StrCat(status.message(), "; trying again"));
  };
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  CCST_ASSIGN_OR_RETURN(const v1::Job job, client.WatchJob(command.job, options, stop));
  return EndOf(job);
}

}  // namespace

ExitCode Run(const WatchCommand& command) {
  const Interrupt interrupt("leaving; the job goes on");
  ProgressPrinter printer(command.progress, stderr);
  const absl::Status status = Watch(command, printer, interrupt.token());
  printer.Finish();
  if (status.ok()) return kOk;
  if (interrupt.token().stop_requested()) {
    const std::string job = PrintableText(command.job);
    std::fprintf(stderr,
                 "ccst: stopped watching; %s goes on: ccst watch %s comes back, ccst cancel %s "
                 "stops it\n",
                 job.c_str(), job.c_str(), job.c_str());
    return kCancelled;
  }
  PrintError(status, command.server);
  return ExitCodeFor(status);
}

}  // namespace ccst::cli
