#pragma once

#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/run_control.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Shows `sink`, unless it is null, the samples and their live triangles. Cost O(n) if there is
/// one.
/// @param surface  of the samples.
void ShowSamples(Stage stage, const Surface& surface, const SampleMesh& mesh,
                 const Samples& samples, StageSink* sink);

}  // namespace ccst::internal
