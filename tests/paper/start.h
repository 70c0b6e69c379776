#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/quality/mesh_topology.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/sampling.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"
#include "tests/paper/crust/crust.h"

/// The algorithm in single steps, for what the command cannot show.
namespace ccst::paper {

using internal::Plan;
using internal::SampleMesh;
using internal::Samples;

/// A surface of one closed component and its initial samples, not yet connected.
struct Start {
  TriangleMesh mesh;  ///< Repaired: hosts are its faces.
  Surface surface;
  Density density;
  Plan plan;
  Samples samples;
};

enum class Points {
  kStrata,  ///< As the sampler draws them: one in each of n strata.
  kWhite,   ///< As the paper does: independent.
  kUneven,  ///< Independent and four times as dense in one half of the surface.
  kEven,    ///< Blue noise already, by sample elimination.
};

/// What each is called on a command line.
const std::map<std::string, Points>& PointsByName();

/// @errors what Repair(), Surface::Build() and MakePlan() say; INVALID_ARGUMENT for surfaces in
///         several pieces or with boundary.
absl::StatusOr<Start> DrawStart(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed,
                                Points points);

/// What Crust makes of the samples of `start`.
struct CrustOutcome {
  std::vector<Eigen::Vector3i> triangles;
  quality::MeshTopology topology;
  bool usable = false;  ///< A manifold through all samples with the topology of the surface.
  double seconds = 0.0;
};
absl::StatusOr<CrustOutcome> RunCrust(const Start& start, const CrustOptions& options);

/// The samples and their mesh in mesh units, with hosts on `start.mesh`.
SampleSet MakeSampleSet(const Start& start, const SampleMesh& mesh);

}  // namespace ccst::paper
