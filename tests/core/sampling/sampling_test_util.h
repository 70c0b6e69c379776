#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/quality/mesh_topology.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/sampling.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

/// What the tests of the sampling room share.
namespace ccst::sampling_test {

using internal::Plan;
using internal::SampleMesh;
using internal::Samples;

/// A surface with its initial samples and their triangulation.
/// Where the number of threads does not matter.
inline const Parallel kOneThread;

struct Start {
  Surface surface;
  Density density;
  Plan plan;
  Samples samples;
  SampleMesh mesh;
};

/// Builds the surface of `mesh`, `count` initial samples on it and their triangulation.
absl::StatusOr<Start> MakeStart(const TriangleMesh& mesh, std::int64_t count,
                                std::uint64_t seed = 0);

/// The live triangles.
std::vector<Eigen::Vector3i> Triangles(const SampleMesh& mesh);

/// The topology of the live triangles over all vertices.
quality::MeshTopology Topology(const SampleMesh& mesh);

/// Sum of the areas of the live triangles.
double Area(const SampleMesh& mesh, const std::vector<Eigen::Vector3d>& positions);

/// Says in what two results differ bit by bit, times left out; empty when in nothing.
std::string FindDifference(const SamplingResult& a, const SamplingResult& b);

/// Says what of a result is wrong: counts, hosts, positions, normals, topology against that of
/// the surface as far as it is triangulated, triangles turned over; empty when nothing is.
std::string FindFault(const TriangleMesh& mesh, std::int64_t count, const SamplingResult& result);

/// A closed surface with six thin, pointed arms; genus 0.
TriangleMesh Jack(int levels);

/// The count named at the end of a COUNT_TOO_SMALL message; -1 when there is none.
std::int64_t SmallestNamed(const absl::Status& status);

}  // namespace ccst::sampling_test
