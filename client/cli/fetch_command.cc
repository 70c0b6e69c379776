#include <cstdio>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/interrupt.h"
#include "client/cli/mesh_input.h"
#include "client/cli/outputs.h"
#include "client/cli/summary.h"
#include "client/lib/client.h"
#include "core/base/sha256.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "proto/convert/enums.h"
#include "proto/convert/names.h"
#include "proto/convert/scalars.h"

namespace ccst::cli {
namespace {

// The mesh that was sampled, and how its file counts faces.
struct Surface {
  TriangleMesh mesh;
  std::vector<std::int32_t> face_source;
  std::vector<Eigen::Vector3i> face_corners;
};

absl::StatusOr<Surface> FromFile(const FetchCommand& command, const v1::Job& job) {
  CCST_ASSIGN_OR_RETURN(MeshInput input, ReadMeshInput(command.surface, command.quantization_bits,
                                                       Transport::kRemote));
  if (MeshName(Sha256Of(input.draco)) != job.mesh()) {
    return absl::InvalidArgumentError(
        absl::StrCat(command.surface, " is not the mesh of ", job.name(),
                     "; name the file, and the --quantization-bits, that it was started with"));
  }
  return Surface{std::move(input.wire), std::move(input.file.face_source),
                 std::move(input.file.face_corners)};
}

absl::StatusOr<Surface> FromServer(Client& client, const v1::Job& job,
                                   const std::stop_token& stop) {
  CCST_ASSIGN_OR_RETURN(const std::string draco, client.DownloadMesh(job.mesh(), stop));
  Surface surface;
  CCST_ASSIGN_OR_RETURN(surface.mesh, DecodeDraco(draco));
  CCST_ASSIGN_OR_RETURN(surface.face_source, DracoFaceSource(draco));
  CCST_ASSIGN_OR_RETURN(surface.face_corners, DracoFaceCorners(draco));
  return surface;
}

// Gives samples the positions and faces that `ccst sample` gives them.
absl::Status PlaceFetched(Client& client, const FetchCommand& command, FetchedJob& fetched,
                          const std::stop_token& stop) {
  SampleSet& samples = fetched.outcome.result.samples;
  const Eigen::Vector3d origin = FromProto(fetched.job.origin());
  const auto surface = command.surface.empty() ? FromServer(client, fetched.job, stop)
                                               : FromFile(command, fetched.job);
  if (absl::IsNotFound(surface.status()) && command.surface.empty()) {
    std::fprintf(stderr,
                 "the server does not have the mesh any more: positions are rounded to 32-bit "
                 "floats and faces are counted in triangles; exact with --surface MESH\n");
    for (Eigen::Vector3d& position : samples.positions) position += origin;
    return absl::OkStatus();
  }
  CCST_RETURN_IF_ERROR(surface.status());
  CCST_RETURN_IF_ERROR(PlaceSamples(surface->mesh, origin, samples));
  NameOwnFaces(surface->face_source, surface->face_corners, samples);
  return absl::OkStatus();
}

absl::StatusOr<FinishedRun> Fetch(const FetchCommand& command, const std::stop_token& stop) {
  CCST_ASSIGN_OR_RETURN(Client client, ConnectTo(command.server, command.server_flags));
  CCST_ASSIGN_OR_RETURN(FetchedJob fetched, client.FetchJob(command.job, stop));
  CCST_RETURN_IF_ERROR(PlaceFetched(client, command, fetched, stop));
  FinishedRun run;
  run.options.seed = fetched.job.effective_options().seed();
  run.options.method =
      FromProto(fetched.job.effective_options().method()).value_or(run.options.method);
  run.server = command.server;
  run.outcome = std::move(fetched.outcome);
  return run;
}

}  // namespace

ExitCode Run(const FetchCommand& command) {
  const Interrupt interrupt;
  const auto run = Fetch(command, interrupt.token());
  if (!run.ok()) {
    PrintError(run.status(), command.server);
    return ExitCodeFor(run.status());
  }
  if (const absl::Status status = WriteOutputs(command, TriangleMesh(), *run); !status.ok()) {
    PrintError(status, command.server);
    return kFailed;
  }
  return kOk;
}

}  // namespace ccst::cli
