#pragma once

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/options.h"
#include "core/sampling/result.h"
#include "core/sampling/run_control.h"

namespace ccst {

/// Distributes options.sample_count blue-noise samples over `mesh` and triangulates them.
///
/// @param mesh     V x 3 positions, F x 3 indices; of any kind. What is not an oriented 2-manifold
///                 is made one first (core/repair/repair.h) and the answer says how.
/// @param options  see SamplingOptions.
/// @param run      stop and progress; being stopped is a result, not an error.
/// @return exactly sample_count samples in an order fixed by mesh, options and seed in which every
///         prefix is well spread (but for white noise, and unless it was stopped or its time was
///         up before they were in order). The same bits for every thread_count, with and without
///         a progress sink.
/// @errors INVALID_ARGUMENT       OPTION_INVALID | DENSITY_INVALID | MESH_EMPTY | MESH_DEGENERATE
/// (names the first
///                                culprit) | COUNT_TOO_SMALL (names the smallest that works)
///         CANCELLED              stopped before there was an iterate to return
///         DEADLINE_EXCEEDED      TIME_LIMIT_EXCEEDED: the time limit passed before there was one;
///                                says what was being done
/// Validation errors come first, then a stop requested before the start.
/// Cost O((n + F) log(n + F)) to start, O(n) an alternation. Thread-safe: a pure function.
/// Source: Xu, Hu, Gotsman, Liu, "Blue noise sampling of surfaces", C&G 36(4), 2012; deviations
///         with reasons in core/docs/algorithm.md.
absl::StatusOr<SamplingResult> SampleSurface(const TriangleMesh& mesh,
                                             const SamplingOptions& options,
                                             const RunControl& run = {});

}  // namespace ccst
