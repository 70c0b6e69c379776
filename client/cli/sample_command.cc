#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/interrupt.h"
#include "client/cli/local_run.h"
#include "client/cli/mesh_input.h"
#include "client/cli/option_flags.h"
#include "client/cli/outputs.h"
#include "client/cli/progress.h"
#include "client/cli/read_within.h"
#include "client/cli/stage_files.h"
#include "client/cli/summary.h"
#include "client/cli/texture_input.h"
#include "client/lib/client.h"
#include "core/base/interrupt.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"

namespace ccst::cli {
namespace {

ExitCode Fail(ProgressPrinter& printer, const absl::Status& status, const std::string& server) {
  printer.Finish();
  PrintError(status, server);
  return ExitCodeFor(status);
}

// A reader that was late is at work still, and nothing ends it but the end of the process.
ExitCode FailToRead(ProgressPrinter& printer, const absl::Status& status,
                    const std::string& server) {
  const ExitCode code = Fail(printer, status, server);
  if (GetErrorReason(status) == ErrorReason::kTimeLimitExceeded) std::_Exit(code);
  return code;
}

absl::StatusOr<DensityOptions> WithTexture(const std::string& path, DensityOptions density) {
  CCST_RETURN_IF_ERROR(ReadTexture(path, density));
  return density;
}

SampleJob ToJob(MeshInput& input, const SampleCommand& command) {
  SampleJob job;
  job.draco = std::move(input.draco);
  job.mesh = std::move(input.wire);
  job.origin = input.origin;
  job.options = command.options;
  job.display_name = command.display_name;
  job.labels = command.labels;
  job.skip_cache_lookup = command.skip_cache_lookup;
  return job;
}

absl::StatusOr<SampleOutcome> SampleRemotely(MeshInput& input, const SampleCommand& command,
                                             ProgressPrinter& printer,
                                             const std::stop_token& stop) {
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  return client.Sample(ToJob(input, command), CallbacksThatShow(printer), stop);
}

// Starts the job and prints its name alone.
absl::Status Detach(MeshInput& input, const SampleCommand& command, ProgressPrinter& printer,
                    const std::stop_token& stop) {
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  CCST_ASSIGN_OR_RETURN(
      const v1::Job job,
      client.CreateJob(ToJob(input, command), CallbacksThatShow(printer).on_upload, stop));
  printer.Finish();
  std::printf("%s\n", PrintableText(job.name()).c_str());
  return absl::OkStatus();
}

bool HasOutput(const SampleCommand& command) {
  return !command.samples_path.empty() || !command.mesh_path.empty() ||
         !command.picture_path.empty() || !command.summary_path.empty();
}

// The end of the time of a job that is computed here: it counts from now on, over all that is done.
std::optional<ccst::Interrupt::Clock::time_point> DeadlineOf(const SampleCommand& command) {
  const std::optional<double>& limit = command.options.time_limit_seconds;
  if (!command.server.empty() || !limit.has_value()) return std::nullopt;
  return ccst::Interrupt::DeadlineAfter(ccst::Interrupt::Clock::now(), *limit);
}

// What reading left of the time limit; not 0, which no limit may be.
SamplingOptions WithTimeLeft(SamplingOptions options,
                             std::optional<ccst::Interrupt::Clock::time_point> deadline) {
  constexpr double kLeast = 1e-9;  // [s]
  if (deadline.has_value()) {
    const std::chrono::duration<double> left = *deadline - ccst::Interrupt::Clock::now();
    options.time_limit_seconds = std::max(left.count(), kLeast);
  }
  return options;
}

}  // namespace

ExitCode Run(const SampleCommand& given) {
  Interrupt interrupt;
  ProgressPrinter printer(given.progress, stderr);
  SampleCommand command = given;
  if (const absl::Status status = CheckOptions(command.options); !status.ok()) {
    return Fail(printer, status, command.server);
  }
  const auto deadline = DeadlineOf(command);
  if (!command.texture_path.empty()) {
    auto density = ReadWithin<DensityOptions>(
        deadline, [path = command.texture_path, density = command.options.density]() mutable {
          return WithTexture(path, std::move(density));
        });
    if (!density.ok()) return FailToRead(printer, density.status(), command.server);
    command.options.density = *std::move(density);
  }
  if (const absl::Status status = command.options.Validate(); !status.ok()) {
    return Fail(printer, status, command.server);
  }
  const bool is_local = command.server.empty();
  auto input = ReadWithin<MeshInput>(
      deadline, [path = command.mesh, bits = command.quantization_bits, is_local] {
        return ReadMeshInput(path, bits, is_local ? Transport::kLocal : Transport::kRemote);
      });
  if (!input.ok()) return FailToRead(printer, input.status(), command.server);
  if (printer.is_for_people()) {
    std::fputs(PrintableText(ReportText(input->file.report), "\n").c_str(), stderr);
  }
  if (command.quantization_bits.has_value() && printer.is_for_people()) {
    std::fprintf(stderr, "quantised to %d bits: %zu bytes, vertices moved by up to %.3g\n",
                 *command.quantization_bits, input->draco.size(), input->max_move);
  }

  if (command.detach) {
    const absl::Status status = Detach(*input, command, printer, interrupt.token());
    return status.ok() ? kOk : Fail(printer, status, command.server);
  }
  StageFiles stages(command.stages_folder, input->origin);
  auto outcome = is_local
                     ? SampleLocally(
                           *input, WithTimeLeft(command.options, deadline),
                           [&printer](const AlternationReport& report) { printer.Show(report); },
                           interrupt.token(), command.stages_folder.empty() ? nullptr : &stages)
                     : SampleRemotely(*input, command, printer, interrupt.token());
  if (outcome.ok() && interrupt.token().stop_requested()) {
    outcome = MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "cancelled");
  }
  if (!outcome.ok()) return Fail(printer, outcome.status(), command.server);
  printer.Finish();
  NameOwnFaces(input->file.face_source, input->file.face_corners, outcome->result.samples);
  const FinishedRun run = {command.options, command.server, *std::move(outcome)};
  absl::Status written = WriteOutputs(command, input->file.mesh, run);
  written.Update(stages.status());
  if (!written.ok()) {
    PrintError(written, command.server);
    return kFailed;
  }
  const std::string figures = SummaryText(run);
  if (!HasOutput(command)) {
    std::fputs(figures.c_str(), stdout);
  } else if (printer.is_for_people()) {
    std::fputs(figures.c_str(), stderr);
  }
  return kOk;
}

}  // namespace ccst::cli
