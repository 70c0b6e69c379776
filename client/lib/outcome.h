#pragma once

#include <string>

#include <Eigen/Core>

#include "absl/status/status.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "proto/convert/result.h"

namespace ccst {

/// A finished run, computed by a server or in the process.
struct SampleOutcome {
  SamplingResult result;
  RunRecord record;
  std::string job_name;  ///< `jobs/{uuid}`; empty for a run in the process.
};

/// Computes positions from hosts and barycentrics on `mesh`, moves them by `origin`, and gives
/// normals the precision of 32-bit floats. Done to every outcome, so that samples do not depend on
/// where they were computed. Cost O(n).
/// @errors DATA_LOSS a host is no face of `mesh`, a weight is not in [0, 1] (names the sample)
absl::Status PlaceSamples(const TriangleMesh& mesh, const Eigen::Vector3d& origin,
                          SampleSet& samples);

}  // namespace ccst
