#include "tests/figures/figures.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "absl/strings/str_format.h"
#include "core/quality/capacity.h"
#include "core/quality/distances.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/quality/surface_distance.h"

namespace ccst::figures {
namespace {

// Minus zero equals zero as a position.
Eigen::Vector3d PlusZero(const Eigen::Vector3d& p) { return p.array() + 0.0; }

bool LexicographicLess(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

TriangleMesh Weld(const TriangleMesh& input) {
  std::vector<bool> used(input.positions.size(), false);
  for (const Eigen::Vector3i& face : input.faces) {
    for (const int v : face) used[v] = true;
  }
  std::vector<std::int32_t> order;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) order.push_back(static_cast<std::int32_t>(v));
  }
  std::stable_sort(order.begin(), order.end(), [&input](std::int32_t a, std::int32_t b) {
    return LexicographicLess(input.positions[a], input.positions[b]);
  });
  TriangleMesh welded;
  std::vector<std::int32_t> target(input.positions.size(), -1);
  for (const std::int32_t v : order) {
    const Eigen::Vector3d position = PlusZero(input.positions[v]);
    if (welded.positions.empty() || welded.positions.back() != position) {
      welded.positions.push_back(position);
    }
    target[v] = static_cast<std::int32_t>(welded.positions.size()) - 1;
  }
  for (const Eigen::Vector3i& face : input.faces) {
    welded.faces.emplace_back(target[face[0]], target[face[1]], target[face[2]]);
  }
  return welded;
}

Eigen::Vector3d FaceNormal(const TriangleMesh& mesh, std::int64_t face) {
  const Eigen::Vector3i& t = mesh.faces[face];
  return (mesh.positions[t[1]] - mesh.positions[t[0]])
      .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
      .normalized();
}

// Share of edges of two faces whose normals are more than 40 degrees apart.
double SharpShare(const TriangleMesh& mesh) {
  const double limit = std::cos(40.0 * M_PI / 180.0);
  std::map<std::pair<int, int>, std::vector<std::int64_t>> faces_of;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int slot = 0; slot < 3; ++slot) {
      const int a = mesh.faces[f][slot], b = mesh.faces[f][(slot + 1) % 3];
      faces_of[std::minmax(a, b)].push_back(static_cast<std::int64_t>(f));
    }
  }
  const auto sharp = std::count_if(faces_of.begin(), faces_of.end(), [&](const auto& entry) {
    const std::vector<std::int64_t>& faces = entry.second;
    return faces.size() == 2 && FaceNormal(mesh, faces[0]).dot(FaceNormal(mesh, faces[1])) < limit;
  });
  return static_cast<double>(sharp) /
         static_cast<double>(std::max<std::size_t>(1, faces_of.size()));
}

double HostError(const TriangleMesh& mesh, const SampleSet& samples, std::size_t i) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::int64_t face = samples.faces[i];
  if (face < 0 || face >= static_cast<std::int64_t>(mesh.faces.size())) return kInfinity;
  const Eigen::Vector2d& w = samples.barycentrics[i];
  if (!(w.minCoeff() >= 0.0) || !(w.sum() <= 1.0)) return kInfinity;
  const Eigen::Vector3i& t = mesh.faces[face];
  const Eigen::Vector3d host = w[0] * mesh.positions[t[0]] + w[1] * mesh.positions[t[1]] +
                               (1.0 - w[0] - w[1]) * mesh.positions[t[2]];
  return (host - samples.positions[i]).norm();
}

// Why distances and angles cannot be measured at all; empty when they can.
std::string WhyUnusable(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  if (samples.faces.size() != count || samples.barycentrics.size() != count ||
      samples.normals.size() != count) {
    return "the arrays of the sample set have different lengths";
  }
  if (samples.triangles.empty()) return "there are no sample triangles";
  const auto finite = [](const Eigen::Vector3d& p) { return p.allFinite(); };
  if (!std::all_of(samples.positions.begin(), samples.positions.end(), finite)) {
    return "a sample has a coordinate that is not finite";
  }
  return "";
}

bool AreJoined(const quality::SamplePair& pair, std::span<const Eigen::Vector3i> triangles) {
  return std::any_of(triangles.begin(), triangles.end(), [&pair](const Eigen::Vector3i& t) {
    return (t.array() == pair.first).any() && (t.array() == pair.second).any();
  });
}

std::string Describe(const quality::SamplePair& pair, const SampleSet& samples,
                     std::span<const Eigen::Vector3d> host_normals) {
  if (pair.first < 0) return "";
  const Eigen::Vector3d& p = samples.positions[pair.first];
  const double cosine = host_normals[pair.first].dot(host_normals[pair.second]);
  return absl::StrFormat(
      "samples %d and %d, %.3g apart near (%.6g, %.6g, %.6g), %s, normals %.0f degrees apart",
      pair.first, pair.second, pair.distance, p.x(), p.y(), p.z(),
      AreJoined(pair, samples.triangles) ? "joined" : "not joined",
      std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / M_PI);
}

}  // namespace

ReferenceSurface::ReferenceSurface(const TriangleMesh& input, Welding welding)
    : mesh_(welding == Welding::kNone ? input : Weld(input)),
      tree_(mesh_.positions, mesh_.faces),
      topology_(
          quality::MeasureTopology(static_cast<std::int64_t>(mesh_.positions.size()), mesh_.faces)),
      area_(quality::TotalArea(mesh_.positions, mesh_.faces)),
      sharp_share_(SharpShare(mesh_)) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh_.positions) box.extend(p);
  diagonal_ = mesh_.positions.empty() ? 0.0 : box.diagonal().norm();
}

std::int64_t ReferenceSurface::CountLoopsShorterThan(double length) const {
  return std::count_if(topology_.boundary_loops.begin(), topology_.boundary_loops.end(),
                       [&](const std::vector<std::int32_t>& loop) {
                         return quality::LoopLength(mesh_.positions, loop) < length;
                       });
}

Figures MeasureFigures(const TriangleMesh& input, const ReferenceSurface& surface,
                       const SampleSet& samples, double spacing) {
  Figures figures;
  const std::size_t count = samples.positions.size();
  figures.samples = static_cast<std::int64_t>(count);
  const quality::MeshTopology topology =
      quality::MeasureTopology(figures.samples, samples.triangles);
  figures.euler = topology.euler;
  figures.components = topology.components;
  figures.boundary_loops = static_cast<std::int64_t>(topology.boundary_loops.size());
  figures.defect = topology.first_defect;
  const std::string unusable = WhyUnusable(samples);
  if (!unusable.empty() || topology.bad_faces > 0) {
    if (!unusable.empty()) figures.defect = unusable;
    figures.max_host_error = figures.max_distance = std::numeric_limits<double>::infinity();
    return figures;
  }

  std::vector<Eigen::Vector3d> host_normals(count, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < count; ++i) {
    figures.max_host_error = std::max(figures.max_host_error, HostError(input, samples, i));
    if (samples.faces[i] >= 0 && samples.faces[i] < static_cast<int>(input.faces.size())) {
      host_normals[i] = FaceNormal(input, samples.faces[i]);
    }
  }
  figures.max_host_error /= surface.diagonal();
  figures.max_distance =
      quality::LargestDistance(samples.positions, surface.tree()) / surface.diagonal();

  figures.capacity_cv = quality::MeasureCapacities(samples.positions, samples.triangles).cv;
  const quality::DistanceFigures distances =
      quality::MeasureDistances(samples.positions, host_normals, surface.area());
  figures.radius = distances.relative_radius;
  figures.radius_same_side = distances.relative_radius_same_side;
  figures.mean_nearest = distances.mean_nearest_distance;
  figures.closest_pair = Describe(distances.closest_same_side, samples, host_normals);

  const quality::AngleFigures angles = quality::MeasureAngles(samples.positions, samples.triangles);
  figures.min_angle = angles.smallest;
  figures.mean_angle = angles.mean_smallest;
  figures.below_30 = angles.share_below_30;
  figures.above_90 = angles.share_above_90;
  figures.valence_5_7 = quality::MeasureValences(figures.samples, samples.triangles).share_5_to_7;
  figures.turned_over =
      quality::CountTurnedOver(samples.positions, samples.normals, samples.triangles);

  const quality::SurfaceDistanceFigures distance = quality::MeasureSurfaceDistance(
      surface.mesh(), surface.tree(), samples.positions, samples.triangles, spacing);
  figures.hausdorff = distance.hausdorff / surface.diagonal();
  figures.rms = distance.rms / surface.diagonal();
  return figures;
}

}  // namespace ccst::figures
