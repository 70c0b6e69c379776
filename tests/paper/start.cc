#include "tests/paper/start.h"

#include <chrono>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/methods/methods.h"
#include "core/repair/repair.h"
#include "core/sampling/start/initial_points.h"

namespace ccst::paper {
namespace {

/// Four where a face lies to the right of the middle, else one.
absl::StatusOr<Density> UnevenDensity(const Surface& surface) {
  std::vector<double> corners;
  for (const Eigen::Vector3i& face : surface.faces()) {
    double x = 0.0;
    for (const std::int32_t v : face) x += surface.positions()[v].x();
    corners.insert(corners.end(), 3, x > 0.0 ? 4.0 : 1.0);
  }
  return Density::Linear(surface, std::move(corners), 100.0);
}

}  // namespace

const std::map<std::string, Points>& PointsByName() {
  static const std::map<std::string, Points>* const names =
      new std::map<std::string, Points>{{"strata", Points::kStrata},
                                        {"white", Points::kWhite},
                                        {"uneven", Points::kUneven},
                                        {"even", Points::kEven}};
  return *names;
}

absl::StatusOr<Start> DrawStart(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed,
                                Points points) {
  Interrupt never;
  CCST_ASSIGN_OR_RETURN(RepairedMesh repaired, Repair(mesh, {}, &never));
  CCST_ASSIGN_OR_RETURN(Surface surface, Surface::Build(repaired.mesh));
  if (surface.component_areas().size() != 1 || !surface.boundary_loops().empty()) {
    return absl::InvalidArgumentError("the paper's start wants a closed surface of one piece");
  }
  Density uniform = Density::Uniform(surface);
  std::int64_t smallest = 0;
  CCST_ASSIGN_OR_RETURN(Plan plan,
                        internal::MakePlan(surface, uniform, {}, count, seed, &smallest));
  Samples samples;
  if (points == Points::kStrata) {
    CCST_ASSIGN_OR_RETURN(samples, DrawInitialPoints(surface, uniform, plan, seed, &never));
  } else {
    Density uneven = uniform;
    if (points == Points::kUneven) {
      CCST_ASSIGN_OR_RETURN(uneven, UnevenDensity(surface));
    }
    const MethodControl control{.interrupt = &never};
    CCST_ASSIGN_OR_RETURN(const std::vector<SurfacePoint> drawn,
                          points == Points::kEven
                              ? EliminateSamples(surface, uniform, count, seed, control)
                              : DrawWhiteNoise(surface, uneven, count, seed, control));
    samples.Resize(static_cast<std::int32_t>(count));
    for (std::int32_t i = 0; i < samples.count(); ++i) samples.Place(i, surface, drawn[i]);
  }
  return Start{std::move(repaired.mesh), std::move(surface), std::move(uniform), std::move(plan),
               std::move(samples)};
}

absl::StatusOr<CrustOutcome> RunCrust(const Start& start, const CrustOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  CCST_ASSIGN_OR_RETURN(Crust crust, ReconstructByCrust(start.samples.position, options));
  CrustOutcome outcome;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  outcome.triangles = std::move(crust.triangles);
  outcome.topology = quality::MeasureTopology(start.samples.count(), outcome.triangles);
  outcome.usable = outcome.topology.IsManifold() && outcome.topology.boundary_loops.empty() &&
                   outcome.topology.components == 1 &&
                   outcome.topology.euler == start.surface.component_eulers()[0];
  return outcome;
}

SampleSet MakeSampleSet(const Start& start, const SampleMesh& mesh) {
  SampleSet set;
  for (std::int32_t i = 0; i < start.samples.count(); ++i) {
    set.positions.push_back(start.surface.ToMesh(start.samples.position[i]));
    set.normals.push_back(start.samples.normal[i]);
    set.faces.push_back(start.samples.face[i]);
    set.barycentrics.emplace_back(start.samples.weights[i].head<2>());
  }
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.IsDead(internal::TriangleIndex(t))) continue;
    set.triangles.emplace_back(mesh.origin[3 * t], mesh.origin[3 * t + 1], mesh.origin[3 * t + 2]);
  }
  return set;
}

}  // namespace ccst::paper
