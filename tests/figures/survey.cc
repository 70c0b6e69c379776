#include "tests/figures/survey.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/mesh_file.h"
#include "core/quality/capacity.h"
#include "core/quality/distances.h"
#include "core/sampling/sampling.h"
#include "tests/figures/floors.h"

namespace ccst::figures {
namespace {

constexpr std::int64_t kLeastCount = 4000;
constexpr std::int64_t kCountPerComponent = 40;

/// Connected component of each face, numbered from 0.
std::vector<std::int32_t> FaceComponents(const TriangleMesh& mesh, std::int32_t* count) {
  std::vector<std::int32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&parent](std::int32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Eigen::Vector3i& face : mesh.faces) {
    parent[find(face[1])] = find(face[0]);
    parent[find(face[2])] = find(face[0]);
  }
  std::vector<std::int32_t> number(mesh.positions.size(), -1);
  std::vector<std::int32_t> components;
  *count = 0;
  for (const Eigen::Vector3i& face : mesh.faces) {
    std::int32_t& component = number[find(face[0])];
    if (component < 0) component = (*count)++;
    components.push_back(component);
  }
  return components;
}

/// The faces for which `wanted` holds, and their vertices.
template <typename Wanted>
TriangleMesh Part(const TriangleMesh& mesh, const Wanted& wanted) {
  TriangleMesh part;
  std::vector<std::int32_t> number(mesh.positions.size(), -1);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (!wanted(f)) continue;
    Eigen::Vector3i face = mesh.faces[f];
    for (std::int32_t& v : face) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(part.positions.size());
        part.positions.push_back(mesh.positions[v]);
      }
      v = number[v];
    }
    part.faces.push_back(face);
  }
  return part;
}

/// The samples of triangles, and those triangles.
SampleSet TriangulatedSamples(const SampleSet& all) {
  SampleSet part;
  std::vector<std::int32_t> number(all.faces.size(), -1);
  part.triangles = all.triangles;
  for (const Eigen::Vector3i& t : all.triangles) {
    for (const std::int32_t v : t) number[v] = 0;
  }
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<std::int32_t>(part.faces.size());
    part.faces.push_back(all.faces[i]);
    part.barycentrics.push_back(all.barycentrics[i]);
    part.positions.push_back(all.positions[i]);
    part.normals.push_back(all.normals[i]);
  }
  for (Eigen::Vector3i& t : part.triangles) {
    for (std::int32_t& v : t) v = number[v];
  }
  return part;
}

/// Most samples with which a component may still be left without triangles: some six for each
/// triangle edge that its topology cannot do without.
std::int64_t MostPoints(const ReferenceSurface& component) {
  return 6 * (3 - component.topology().euler);
}

/// Smallest distance of samples on the same side at most three edges apart. Of two on boundaries
/// only those joined by an edge or facing each other across one count: others are neighbours
/// around the end of a slit, whose two sides may touch.
double NearestOnSheet(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  std::vector<std::vector<std::int32_t>> neighbours(count);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> apex;  // Of directed edges.
  for (const Eigen::Vector3i& t : samples.triangles) {
    for (int k = 0; k < 3; ++k) {
      neighbours[t[k]].push_back(t[(k + 1) % 3]);
      neighbours[t[(k + 1) % 3]].push_back(t[k]);
      apex[{t[k], t[(k + 1) % 3]}] = t[(k + 2) % 3];
    }
  }
  std::vector<std::uint8_t> on_boundary(count, 0);
  double nearest = std::numeric_limits<double>::infinity();
  const auto compare = [&](std::int32_t u, std::int32_t v) {
    if (samples.normals[u].dot(samples.normals[v]) <= 0.0) return;
    nearest = std::min(nearest, (samples.positions[u] - samples.positions[v]).norm());
  };
  for (const auto& [edge, opposite] : apex) {
    compare(edge.first, edge.second);
    const auto twin = apex.find({edge.second, edge.first});
    if (twin == apex.end()) {
      on_boundary[edge.first] = on_boundary[edge.second] = 1;
    } else {
      compare(opposite, twin->second);
    }
  }
  std::vector<std::int32_t> found;
  std::vector<std::int32_t> seen(count, -1);
  for (std::size_t v = 0; v < count; ++v) {
    found.assign(1, static_cast<std::int32_t>(v));
    seen[v] = static_cast<std::int32_t>(v);
    std::size_t begin = 0;
    for (int step = 0; step < 3; ++step) {
      for (const std::size_t end = found.size(); begin < end; ++begin) {
        for (const std::int32_t u : neighbours[found[begin]]) {
          if (std::exchange(seen[u], static_cast<std::int32_t>(v)) == static_cast<int>(v)) continue;
          found.push_back(u);
          if (!on_boundary[u] || !on_boundary[v]) compare(u, static_cast<std::int32_t>(v));
        }
      }
    }
  }
  return nearest;
}

/// Divides by a power of two near the size of the mesh, so that no figure overflows; exact.
void Rescale(double unit, std::vector<Eigen::Vector3d>* positions) {
  for (Eigen::Vector3d& p : *positions) p /= unit;
}

/// Fills in what `result` is worth on the repaired surface.
void Judge(TriangleMesh input, RepairedMesh repaired, SamplingResult result, Survey* survey) {
  RunRecord& run = survey->run;
  double reach = 0.0;
  for (const Eigen::Vector3d& p : repaired.mesh.positions) {
    reach = std::max(reach, p.cwiseAbs().maxCoeff());
  }
  const double unit = std::exp2(std::floor(std::log2(reach)));
  Rescale(unit, &input.positions);
  Rescale(unit, &repaired.mesh.positions);
  Rescale(unit, &result.samples.positions);
  std::int32_t count = 0;
  const std::vector<std::int32_t> components = FaceComponents(repaired.mesh, &count);
  // Components with sample triangles, by the hosts of their corners.
  std::vector<std::int32_t> component_of(input.faces.size(), -1);
  for (std::size_t f = 0; f < components.size(); ++f) {
    component_of[repaired.source_face[f]] = components[f];
  }
  std::vector<std::uint8_t> triangulated(count, 0);
  for (const Eigen::Vector3i& t : result.samples.triangles) {
    for (const std::int32_t v : t) {
      const std::int32_t c = component_of[result.samples.faces[v]];
      if (c >= 0) triangulated[c] = 1;
    }
  }
  const double area = quality::TotalArea(repaired.mesh.positions, repaired.mesh.faces);
  bool points_are_excused = true;
  for (std::int32_t c = 0; c < count; ++c) {
    if (triangulated[c]) continue;
    const ReferenceSurface component(
        Part(repaired.mesh, [&](std::size_t f) { return components[f] == c; }), Welding::kNone);
    const double share = static_cast<double>(run.sample_count) * component.area() / area;
    if (share > static_cast<double>(MostPoints(component))) points_are_excused = false;
  }
  const SampleSet samples = TriangulatedSamples(result.samples);
  const auto used = static_cast<std::int64_t>(samples.faces.size());
  if (used > 0) {
    const ReferenceSurface surface(
        Part(repaired.mesh, [&](std::size_t f) { return triangulated[components[f]] != 0; }),
        Welding::kNone);
    // A needle's area says nothing of its length; what is missed is a thirtieth of the floor.
    const double spacing = std::max(std::sqrt(surface.area() / 1e5), surface.diagonal() / 2000.0);
    run.figures = MeasureFigures(input, surface, samples, spacing);
    run.misses = FindMisses(run.figures, surface, used, run.closed_loops);
    survey->radius_on_sheet =
        NearestOnSheet(samples) / quality::HexagonalSpacing(surface.area(), used);
    if (survey->radius_on_sheet >= FloorsFor(surface, used).radius_same_side) {
      run.misses.erase("radius");
    }
  }
  const bool stated = result.surface.untriangulated_components ==
                          std::count(triangulated.begin(), triangulated.end(), std::uint8_t{0}) &&
                      result.surface.untriangulated_samples == run.sample_count - used;
  if (!points_are_excused || !stated) run.misses.insert("points");
  if (static_cast<std::int64_t>(result.samples.faces.size()) != run.sample_count) {
    run.misses.insert("n");
  }
}

}  // namespace

Survey SurveyFile(const std::string& path, std::uint64_t seed) {
  Survey survey;
  RunRecord& run = survey.run;
  run.seed = seed;
  absl::StatusOr<MeshFile> file = ReadMeshFile(path);
  if (!file.ok()) {
    run.error = file.status().ToString();
    return survey;
  }
  survey.readable = true;
  absl::StatusOr<RepairedMesh> repaired = Repair(file->mesh);
  if (!repaired.ok()) {
    run.error = repaired.status().ToString();
    return survey;
  }
  survey.repairs = repaired->report;
  std::int32_t components = 0;
  FaceComponents(repaired->mesh, &components);
  survey.components = components;
  SamplingOptions options;
  options.sample_count = run.sample_count = std::max(kLeastCount, kCountPerComponent * components);
  options.seed = seed;
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<SamplingResult> result = SampleSurface(file->mesh, options);
  run.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!result.ok()) {
    run.error = result.status().ToString();
    return survey;
  }
  survey.untriangulated_components = result->surface.untriangulated_components;
  survey.untriangulated_samples = result->surface.untriangulated_samples;
  run.closed_loops = result->surface.closed_loops;
  run.alternations = result->alternations;
  run.passes = result->passes;
  run.termination = result->termination;
  run.prepare_seconds = result->prepare_seconds;
  run.initialise_seconds = result->initialise_seconds;
  run.optimise_seconds = result->optimise_seconds;
  Judge(std::move(file->mesh), *std::move(repaired), *std::move(result), &survey);
  return survey;
}

std::string DescribeRepairs(const RepairReport& report) {
  std::string text;
  const auto add = [&text](std::int64_t count, const char* name) {
    if (count != 0) absl::StrAppend(&text, text.empty() ? "" : ", ", count, " ", name);
  };
  add(report.welded_vertices, "welded");
  add(report.isolated_vertices, "isolated");
  add(report.repeated_index_faces, "repeated index");
  add(report.duplicate_faces, "duplicate");
  add(report.degenerate_faces, "degenerate");
  add(report.split_faces, "split");
  add(report.cut_edges, "cut edges");
  add(report.non_orientable_cuts, "non-orientable cuts");
  add(report.cut_vertices, "cut vertices");
  add(report.flipped_faces, "flipped");
  return text.empty() ? "-" : text;
}

}  // namespace ccst::figures
