#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/sampling/input/source_map.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/result.h"

namespace ccst::internal {

/// The samples as callers see them: on the faces of the input, in mesh units.
/// @param mesh     the input. @param sources  where the surface's faces lie on it.
/// @param order    a permutation: entry k is the sample that becomes the k-th.
/// The same on any number of threads.
SampleSet ExportSamples(const TriangleMesh& mesh, const SourceMap& sources, const Samples& samples,
                        const SampleMesh& triangulation, const std::vector<std::int32_t>& order,
                        const Parallel& parallel);

}  // namespace ccst::internal
