#include "tests/core/sampling/sampling_test_util.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/quality/surface_distance.h"
#include "core/quality/triangle_tree.h"
#include "core/sampling/start/initial_mesh.h"
#include "core/sampling/start/initial_points.h"
#include "tests/support/sample_hosts.h"
#include "tests/support/shapes.h"

namespace ccst::sampling_test {
namespace {

template <typename T>
bool SameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

}  // namespace

absl::StatusOr<Start> MakeStart(const TriangleMesh& mesh, std::int64_t count, std::uint64_t seed) {
  Interrupt never;
  CCST_ASSIGN_OR_RETURN(Surface surface, Surface::Build(mesh));
  std::int64_t smallest = 0;
  Density density = Density::Uniform(surface);
  CCST_ASSIGN_OR_RETURN(Plan plan,
                        internal::MakePlan(surface, density, {}, count, seed, &smallest));
  CCST_ASSIGN_OR_RETURN(Samples samples, DrawInitialPoints(surface, density, plan, seed, &never));
  CCST_ASSIGN_OR_RETURN(SampleMesh triangulation, BuildInitialMesh(surface, plan, samples, &never));
  return Start{std::move(surface), std::move(density), std::move(plan), std::move(samples),
               std::move(triangulation)};
}

std::vector<Eigen::Vector3i> Triangles(const SampleMesh& mesh) {
  std::vector<Eigen::Vector3i> triangles;
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.IsDead(internal::TriangleIndex(t))) continue;
    triangles.emplace_back(mesh.origin[3 * t], mesh.origin[3 * t + 1], mesh.origin[3 * t + 2]);
  }
  return triangles;
}

quality::MeshTopology Topology(const SampleMesh& mesh) {
  return quality::MeasureTopology(mesh.vertex_count(), Triangles(mesh));
}

double Area(const SampleMesh& mesh, const std::vector<Eigen::Vector3d>& positions) {
  double area = 0.0;
  for (const Eigen::Vector3i& t : Triangles(mesh)) {
    area +=
        0.5 * (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]).norm();
  }
  return area;
}

std::string FindDifference(const SamplingResult& a, const SamplingResult& b) {
  if (!SameBits(a.samples.faces, b.samples.faces)) return "faces";
  if (!SameBits(a.samples.barycentrics, b.samples.barycentrics)) return "barycentrics";
  if (!SameBits(a.samples.positions, b.samples.positions)) return "positions";
  if (!SameBits(a.samples.normals, b.samples.normals)) return "normals";
  if (!SameBits(a.samples.triangles, b.samples.triangles)) return "triangles";
  if (a.termination != b.termination) return "termination";
  if (a.alternations != b.alternations) return "alternations";
  if (a.passes != b.passes) return "passes";
  if (a.energy != b.energy) return "energy";
  if (a.capacity_cv != b.capacity_cv) return "capacity_cv";
  if (a.relative_radius != b.relative_radius) return "relative_radius";
  return "";
}

std::string FindFault(const TriangleMesh& mesh, std::int64_t count, const SamplingResult& result) {
  const SampleSet& set = result.samples;
  const double tolerance = 1e-12 * result.surface.diagonal;
  const std::string fault = test::FindHostFault(
      mesh, count, set, [tolerance](const Eigen::Vector3i& /*face*/) { return tolerance; });
  if (!fault.empty()) return fault;
  const quality::TriangleTree tree(mesh.positions, mesh.faces);
  const double off = quality::LargestDistance(set.positions, tree);
  if (!(off <= 1e-6 * result.surface.diagonal)) return absl::StrCat("a sample lies ", off, " off");
  // Samples in no triangle must be those of the components said to have none.
  std::vector<std::int32_t> number(set.positions.size(), -1);
  std::int32_t used = 0;
  std::vector<Eigen::Vector3i> triangles = set.triangles;
  for (Eigen::Vector3i& t : triangles) {
    for (std::int32_t& v : t) v = number[v] < 0 ? number[v] = used++ : number[v];
  }
  if (count - used != result.surface.untriangulated_samples) {
    return absl::StrCat(count - used, " samples belong to no triangle instead of ",
                        result.surface.untriangulated_samples);
  }
  const quality::MeshTopology topology = quality::MeasureTopology(used, triangles);
  if (!topology.IsManifold()) return topology.first_defect;
  if (topology.components != result.surface.components - result.surface.untriangulated_components) {
    return absl::StrCat(topology.components, " components");
  }
  if (result.surface.untriangulated_components > 0) return "";
  if (topology.euler != result.surface.euler + result.surface.closed_loops) {
    return absl::StrCat("Euler characteristic ", topology.euler, " instead of ",
                        result.surface.euler + result.surface.closed_loops);
  }
  const auto loops = static_cast<std::int64_t>(topology.boundary_loops.size());
  if (loops != result.surface.boundary_loops - result.surface.closed_loops) {
    return absl::StrCat(loops, " boundary loops");
  }
  const std::int64_t turned = quality::CountTurnedOver(set.positions, set.normals, set.triangles);
  if (turned > 0) return absl::StrCat(turned, " triangles turned over");
  return "";
}

TriangleMesh Jack(int levels) {
  TriangleMesh mesh = shapes::Icosphere(levels);
  for (Eigen::Vector3d& p : mesh.positions) {
    const double along = p.cwiseAbs().maxCoeff();  // 1 at the axes, 0.577 between them.
    const double arm = std::max(0.0, (along - 0.8) / 0.2);
    p *= 1.0 + 2.5 * arm * arm;
  }
  return mesh;
}

std::int64_t SmallestNamed(const absl::Status& status) {
  const std::string message(status.message());
  const std::string key = "the smallest that works is ";
  const std::size_t at = message.find(key);
  return at == std::string::npos ? -1 : std::atoll(message.c_str() + at + key.size());
}

}  // namespace ccst::sampling_test
