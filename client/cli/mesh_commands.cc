#include <cstdio>
#include <filesystem>
#include <string>

#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/interrupt.h"
#include "client/cli/listing.h"
#include "client/cli/mesh_input.h"
#include "client/cli/progress.h"
#include "client/lib/client.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"
#include "proto/convert/names.h"

namespace ccst::cli {
namespace {

// The end of the file's name, at most as much as a server takes.
std::string DisplayName(const UploadCommand& command) {
  if (!command.display_name.empty() || command.mesh == "-") return command.display_name;
  const std::string name = std::filesystem::path(command.mesh).filename().string();
  return CountCharacters(name) <= kMaxDisplayName ? name : "";
}

absl::StatusOr<v1::Mesh> Upload(const UploadCommand& command, ProgressPrinter& printer,
                                const std::stop_token& stop) {
  CCST_ASSIGN_OR_RETURN(const MeshInput input,
                        ReadMeshInput(command.mesh, command.quantization_bits, Transport::kRemote));
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  return client.UploadMesh(input.draco, DisplayName(command), CallbacksThatShow(printer).on_upload,
                           stop);
}

absl::StatusOr<std::vector<v1::Mesh>> List(const MeshesCommand& command) {
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  return client.ListMeshes();
}

}  // namespace

ExitCode Run(const UploadCommand& command) {
  const Interrupt interrupt;
  ProgressPrinter printer(command.progress, stderr);
  const auto mesh = Upload(command, printer, interrupt.token());
  printer.Finish();
  if (!mesh.ok()) {
    PrintError(mesh.status(), command.server);
    return ExitCodeFor(mesh.status());
  }
  std::printf("%s\n", PrintableText(mesh->name()).c_str());
  return kOk;
}

ExitCode Run(const MeshesCommand& command) {
  const auto meshes = List(command);
  if (!meshes.ok()) {
    PrintError(meshes.status(), command.server);
    return ExitCodeFor(meshes.status());
  }
  std::fputs((command.json ? MeshesJson(*meshes) : MeshesText(*meshes)).c_str(), stdout);
  return kOk;
}

}  // namespace ccst::cli
