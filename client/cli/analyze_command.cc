#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/commands.h"
#include "client/cli/errors.h"
#include "client/cli/option_flags.h"
#include "client/cli/texture_input.h"
#include "client/render/picture.h"
#include "client/report/report.h"
#include "core/analysis/sample_figures.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"
#include "core/io/atomic_file.h"
#include "core/io/mesh_file.h"
#include "core/io/sample_file.h"
#include "core/parallel/parallel.h"
#include "core/sampling/input/prepared_surface.h"

namespace ccst::cli {
namespace {

absl::StatusOr<analysis::ReferenceSurface> MakeReference(const TriangleMesh& mesh,
                                                         const DensityOptions& density,
                                                         const Parallel& parallel) {
  SamplingOptions options;
  options.density = density;
  CCST_ASSIGN_OR_RETURN(
      internal::PreparedSurface prepared,
      internal::Prepare(mesh, options, internal::Purpose::kMeasuring, nullptr, parallel));
  return analysis::ReferenceSurface(std::move(prepared.surface), std::move(prepared.density));
}

// The samples on the surface, as they are drawn.
absl::StatusOr<std::string> Draw(const TriangleMesh& mesh,
                                 const analysis::ReferenceSurface& reference,
                                 const TriangleMesh& samples) {
  constexpr PictureOptions kPicture{1200, 600, 2};
  SampleSet set;
  set.positions = samples.positions;
  set.triangles = samples.faces;
  for (const SurfacePoint& point : reference.Locate(reference.ToFrame(samples.positions))) {
    set.normals.push_back(reference.surface().NormalAt(point.face, point.weights));
  }
  CCST_ASSIGN_OR_RETURN(const RgbImage image, RenderPicture(mesh, set, kPicture));
  return EncodePng(image);
}

// What all groups are judged on, if it was given.
struct GivenSurface {
  TriangleMesh mesh;
  analysis::ReferenceSurface reference;
};

absl::StatusOr<report::Row> Judge(const SampleGroup& group, const GivenSurface* given,
                                  bool with_picture, const Parallel& parallel) {
  std::vector<TriangleMesh> files;
  for (const std::string& path : group.paths) {
    CCST_ASSIGN_OR_RETURN(TriangleMesh file, ReadSamplesFile(path));
    files.push_back(std::move(file));
  }
  report::Row row;
  row.name = PrintableText(group.name);
  row.count = static_cast<std::int64_t>(files.front().positions.size());
  std::vector<analysis::SampleSetView> sets;
  sets.reserve(files.size());
  for (const TriangleMesh& file : files) sets.push_back({file.positions, file.faces});
  if (given != nullptr) {
    row.figures = analysis::MeasureSamples(given->reference, sets, {}, parallel);
    if (with_picture) {
      CCST_ASSIGN_OR_RETURN(row.picture, Draw(given->mesh, given->reference, files.front()));
    }
    return row;
  }
  if (files.front().faces.empty()) return row;  // On what they lie is not known.
  CCST_ASSIGN_OR_RETURN(const analysis::ReferenceSurface own,
                        MakeReference(files.front(), DensityOptions(), parallel));
  row.figures = analysis::MeasureSamples(own, sets, {.surface_distance = false}, parallel);
  if (with_picture) {
    CCST_ASSIGN_OR_RETURN(row.picture, Draw(files.front(), own, files.front()));
  }
  return row;
}

absl::StatusOr<std::vector<report::Row>> JudgeAll(const AnalyzeCommand& command) {
  CCST_RETURN_IF_ERROR(CheckOptions(command.density));
  const Parallel parallel(command.thread_count);
  std::optional<GivenSurface> given;
  if (!command.surface.empty()) {
    DensityOptions density = command.density;
    if (!command.texture_path.empty()) {
      CCST_RETURN_IF_ERROR(ReadTexture(command.texture_path, density));
    }
    CCST_ASSIGN_OR_RETURN(MeshFile file, ReadMeshFile(command.surface));
    CCST_ASSIGN_OR_RETURN(analysis::ReferenceSurface reference,
                          MakeReference(file.mesh, density, parallel));
    given.emplace(GivenSurface{std::move(file.mesh), std::move(reference)});
  }
  std::vector<report::Row> rows;
  for (const SampleGroup& group : command.groups) {
    CCST_ASSIGN_OR_RETURN(report::Row row, Judge(group, given.has_value() ? &*given : nullptr,
                                                 !command.html_path.empty(), parallel));
    if (!row.figures.has_value()) {
      std::fprintf(stderr,
                   "%s has no faces: nothing but the count is known without --surface MESH\n",
                   PrintableText(group.paths.front()).c_str());
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

absl::Status Write(const AnalyzeCommand& command, const std::vector<report::Row>& rows) {
  if (!command.json_path.empty()) {
    CCST_RETURN_IF_ERROR(WriteFileAtomically(command.json_path, report::ToJson(rows)));
  }
  if (!command.html_path.empty()) {
    CCST_RETURN_IF_ERROR(WriteFileAtomically(command.html_path, report::ToPage(rows)));
  }
  if (command.json_path.empty() && command.html_path.empty()) {
    std::fputs(report::ToText(rows).c_str(), stdout);
  }
  return absl::OkStatus();
}

}  // namespace

ExitCode Run(const AnalyzeCommand& command) {
  const auto rows = JudgeAll(command);
  if (!rows.ok()) {
    PrintError(rows.status(), "");
    return ExitCodeFor(rows.status());
  }
  if (const absl::Status status = Write(command, *rows); !status.ok()) {
    PrintError(status, "");
    return kFailed;
  }
  return kOk;
}

}  // namespace ccst::cli
