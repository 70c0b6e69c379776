#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <Eigen/Core>

#include "core/mesh/triangle_mesh.h"
#include "core/sampling/result.h"

namespace ccst::test {

/// How far [mesh unit] a sample may lie from where its host says, by the corners of the host.
using HostTolerance = std::function<double(const Eigen::Vector3i& face)>;

/// What is wrong with the samples of `set` by themselves: not `count` of each column, a host that
/// `mesh` does not have, a place outside of it or other than its barycentrics say, or a normal that
/// is no unit vector. Empty when nothing is.
std::string FindHostFault(const TriangleMesh& mesh, std::int64_t count, const SampleSet& set,
                          const HostTolerance& tolerance);

}  // namespace ccst::test
