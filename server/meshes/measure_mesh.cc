#include "server/meshes/measure_mesh.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/base/status.h"
#include "core/mesh/attributes.h"
#include "core/repair/repair.h"
#include "core/surface/surface.h"

namespace ccst::server {
namespace {

// Values that are not finite are passed over.
MeshAttributeFacts FactsOf(const Attribute& attribute) {
  MeshAttributeFacts facts{.name = attribute.name, .components = attribute.components};
  bool first = true;
  for (const float value : attribute.values) {
    if (!std::isfinite(value)) continue;
    facts.min_value = first ? value : std::min<double>(facts.min_value, value);
    facts.max_value = first ? value : std::max<double>(facts.max_value, value);
    first = false;
  }
  return facts;
}

std::vector<std::string> WarningsOf(const RepairReport& repairs) {
  std::vector<std::string> warnings;
  const auto add = [&warnings](std::int64_t count, const char* what) {
    if (count > 0) warnings.push_back(std::to_string(count) + " " + what);
  };
  add(repairs.welded_vertices, "vertices are at the place of another and are joined with it");
  add(repairs.isolated_vertices, "vertices have no face and are dropped");
  add(repairs.repeated_index_faces, "faces use a vertex twice and are dropped");
  add(repairs.duplicate_faces, "faces are copies of another and are dropped");
  add(repairs.degenerate_faces, "faces have no area and are dropped or replaced");
  add(repairs.split_faces, "faces have a vertex on their side and are split there");
  add(repairs.cut_edges, "edges have three or more faces and are cut");
  add(repairs.non_orientable_cuts, "edges are cut to make the surface orientable");
  add(repairs.cut_vertices, "copies of vertices are made where the faces are no single fan");
  add(repairs.flipped_faces, "faces are turned over to agree with their neighbours");
  return warnings;
}

}  // namespace

absl::StatusOr<MeshFacts> MeasureMesh(const TriangleMesh& mesh) {
  CCST_RETURN_IF_ERROR(CheckAttributes(mesh));
  RepairedMesh repaired;
  CCST_ASSIGN_OR_RETURN(repaired, Repair(mesh));
  CCST_ASSIGN_OR_RETURN(const Surface surface, Surface::Build(repaired.mesh));
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : repaired.mesh.positions) box.extend(position);
  MeshFacts facts{.vertices = surface.vertex_count(),
                  .file_faces = static_cast<std::int64_t>(mesh.faces.size()),
                  .components = static_cast<std::int64_t>(surface.component_areas().size()),
                  .boundary_loops = static_cast<std::int64_t>(surface.boundary_loops().size()),
                  .area = surface.area() * surface.unit() * surface.unit(),
                  .bounds_min = box.min(),
                  .bounds_max = box.max(),
                  .attributes = {},
                  .warnings = WarningsOf(repaired.report)};
  std::transform(mesh.attributes.begin(), mesh.attributes.end(),
                 std::back_inserter(facts.attributes), FactsOf);
  return facts;
}

}  // namespace ccst::server
