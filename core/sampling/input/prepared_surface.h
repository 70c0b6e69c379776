#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/repair/repair_report.h"
#include "core/sampling/input/source_map.h"
#include "core/sampling/options.h"
#include "core/sampling/run_control.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// What a surface is prepared for.
enum class Purpose {
  /// Faces and vertices are put in the order in which they lie on the surface. For
  /// SamplingMethod::kCcst, large faces at sharp edges are split too.
  kSampling,
  /// Faces and vertices stay as Repair() leaves them: samples that exist are measured.
  kMeasuring,
};

/// A mesh ready to be sampled or measured on. The steps are the same for all who need one: repair,
/// order of the faces, surface, refinement at creases, sources of the faces, density.
struct PreparedSurface {
  RepairReport repairs;           ///< What it took to make a surface of the input.
  std::int64_t vertex_count = 0;  ///< Of the repaired mesh, before any face was split.
  std::int64_t face_count = 0;    ///< The same.
  Surface surface;                ///< Of one face for each of the repaired mesh, or more.
  SourceMap sources;              ///< From the faces of `surface` to those of the input.
  Density density;                ///< On `surface`.
};

/// Prepares `mesh` as `options` ask: their weld tolerance, density and, to split faces, method and
/// number of samples.
/// @param options    need not have been validated, but for the density: CheckOptions().
/// @param interrupt  polled within the steps; may be null.
/// @param stages     shown the repaired mesh and, if any face was split, the refined one; may be
///                   null.
/// @errors those of Repair(), Surface::Build() and MakeDensity(); those of Interrupt::Error().
/// Cost O((V + F) log F), and O(pixels) for an image; the same bits on any number of threads.
absl::StatusOr<PreparedSurface> Prepare(const TriangleMesh& mesh, const SamplingOptions& options,
                                        Purpose purpose, Interrupt* interrupt = nullptr,
                                        const Parallel& parallel = Parallel(),
                                        StageSink* stages = nullptr);

}  // namespace ccst::internal
