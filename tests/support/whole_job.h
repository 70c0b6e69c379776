#pragma once

#include <cstdint>
#include <string>

#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst::test {

/// What one job may take.
struct JobBounds {
  double seconds = 60.0;  ///< Also its time limit, which ends what never would.
  std::int64_t bytes = std::int64_t{64} << 20;
};

/// Runs SampleSurface() and says in what it did not keep its promises: whatever the mesh, either
/// exactly as many samples as were asked for, each in a face of the mesh, or a refusal that lies in
/// the request and says why, within the bounds. Empty when it did. `options` have no time limit.
std::string FindMisbehaviour(const TriangleMesh& mesh, SamplingOptions options,
                             const JobBounds& bounds = {});

}  // namespace ccst::test
