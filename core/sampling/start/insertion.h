#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// The surface's faces with the samples inserted. Vertices: samples, then the surface's own, then
/// one per closed loop. A sample at a corner takes the place of the surface's vertex there.
struct InsertedSamples {
  SampleMesh mesh;
  std::vector<Eigen::Vector3d> positions;  ///< Per vertex, as normals.
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::int32_t> components;  ///< Per vertex, of the surface.
};

/// Inserts samples into the surface's own faces: boundary and crease samples into edges, then the
/// others face by face, each face by itself, on several threads. Loops the plan closes are filled
/// by a fan, faces of components that get points are left out. The same on any number of threads.
/// @param interrupt  when requested, the result is unfinished. Cost O(F + n) expected.
InsertedSamples InsertSamples(const Surface& surface, const Plan& plan, const Samples& samples,
                              const Parallel& parallel, Interrupt* interrupt);

}  // namespace ccst::internal
