#include "core/sampling/input/prepared_surface.h"

#include <utility>

#include "core/base/status.h"
#include "core/quality/distances.h"
#include "core/repair/repair.h"
#include "core/sampling/input/crease_refinement.h"
#include "core/sampling/input/density_source.h"
#include "core/sampling/input/face_order.h"

namespace ccst::internal {
namespace {

/// Longest side of a face at a sharp edge, in spacings, and how many faces a sample may come of it.
constexpr double kLargestAtCrease = 1.0;
constexpr std::int64_t kMostNewFaces = 8;

}  // namespace

absl::StatusOr<PreparedSurface> Prepare(const TriangleMesh& mesh, const SamplingOptions& options,
                                        Purpose purpose, Interrupt* interrupt,
                                        const Parallel& parallel, StageSink* stages) {
  Interrupt never;
  Interrupt* const stop = interrupt != nullptr ? interrupt : &never;
  CCST_ASSIGN_OR_RETURN(RepairedMesh repaired,
                        Repair(mesh, {.weld_tolerance = options.weld_tolerance}, stop, parallel));
  // Of a run that is to stop, the mesh may be none any more.
  const auto show = [&](Stage stage) {
    if (stages == nullptr || stop->Requested()) return;
    stages->OnStage(stage, repaired.mesh.positions, repaired.mesh.faces);
  };
  if (purpose == Purpose::kSampling) SortFaces(&repaired, stop, parallel);
  show(Stage::kRepaired);
  CCST_ASSIGN_OR_RETURN(Surface surface, Surface::Build(repaired.mesh, stop, parallel));
  const std::int64_t vertex_count = surface.vertex_count();
  const std::int64_t face_count = surface.face_count();
  if (purpose == Purpose::kSampling && options.method == SamplingMethod::kCcst) {
    const double spacing = quality::HexagonalSpacing(surface.area(), options.sample_count);
    if (RefineCreases(surface, kLargestAtCrease * spacing, kMostNewFaces * options.sample_count,
                      &repaired, stop)) {
      SortFaces(&repaired, stop, parallel);
      show(Stage::kRefined);
      CCST_ASSIGN_OR_RETURN(surface, Surface::Build(repaired.mesh, stop, parallel));
    }
  }
  if (stop->Requested()) return stop->Error("the mesh was prepared");
  SourceMap sources(mesh, repaired);
  repaired.mesh = {};  // From here on there is the surface.
  CCST_ASSIGN_OR_RETURN(Density density,
                        MakeDensity(mesh, sources, surface, options.density, stop));
  return PreparedSurface{.repairs = repaired.report,
                         .vertex_count = vertex_count,
                         .face_count = face_count,
                         .surface = std::move(surface),
                         .sources = std::move(sources),
                         .density = std::move(density)};
}

}  // namespace ccst::internal
