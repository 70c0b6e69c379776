#include "core/analysis/sample_figures.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/analysis/density_fidelity.h"
#include "core/analysis/differentials.h"
#include "core/analysis/spectral_figures.h"
#include "core/quality/bond_order.h"
#include "core/quality/capacity.h"
#include "core/quality/distances.h"
#include "core/quality/sample_mesh_quality.h"
#include "core/quality/surface_distance.h"
#include "core/quality/voronoi_cells.h"

namespace ccst::analysis {
namespace {

// 1 / sqrt(density), in which Differentials count, over r_max.
const double kSpacing = std::sqrt(0.5 * std::sqrt(3.0));

// Counts values in equal bins; the last also takes those beyond.
class Histogram {
 public:
  Histogram(double width, int bins) : width_(width), counts_(static_cast<std::size_t>(bins), 0.0) {}

  void Add(double value, double times = 1.0) {
    const double bin = std::clamp(value / width_, 0.0, static_cast<double>(counts_.size() - 1));
    counts_[static_cast<std::size_t>(bin)] += times;
    total_ += times;
  }

  // Shares, by the middles of the bins.
  Curve ToCurve(double first = 0.5) const {
    Curve curve;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      curve.x.push_back((static_cast<double>(i) + first) * width_);
      curve.y.push_back(total_ > 0.0 ? counts_[i] / total_ : 0.0);
    }
    return curve;
  }

 private:
  double width_;
  std::vector<double> counts_;
  double total_ = 0.0;
};

Curve OverRMax(Curve curve) {
  for (double& x : curve.x) x *= kSpacing;
  return curve;
}

// Adds up what is measured of sets, one by one.
class Sum {
 public:
  Sum(const ReferenceSurface& reference, const FigureOptions& options, const Parallel& parallel,
      Interrupt* interrupt, std::int64_t count, std::size_t sets)
      : reference_(reference),
        options_(options),
        parallel_(parallel),
        interrupt_(interrupt),
        share_(1.0 / static_cast<double>(sets)),
        differentials_(count) {}

  void Add(const SampleSetView& set) {
    if (Stopped()) return;
    const std::vector<Eigen::Vector3d> positions = reference_.ToFrame(set.positions);
    const std::vector<SurfacePoint> points = reference_.Locate(positions, parallel_, interrupt_);
    if (Stopped()) return;
    AddDistances(positions, points);
    if (Stopped()) return;
    differentials_.AddSurface(reference_.surface(), reference_.density(), points, parallel_,
                              interrupt_);
    if (Stopped()) return;
    figures_.density_fidelity +=
        share_ * MeasureDensityFidelity(reference_.surface(), reference_.density(), points);
    if (Stopped()) return;
    if (!set.triangles.empty()) AddMesh(positions, set.triangles, points);
  }

  SampleFigures Finish() && {
    const Curve power = differentials_.PowerSpectrum();
    const SpectralFigures spectral = MeasureSpectrum(power);
    figures_.effective_nyquist = spectral.effective_nyquist;
    figures_.oscillation = spectral.oscillation;
    figures_.power_spectrum = power;
    figures_.radial_mean = OverRMax(differentials_.RadialMean());
    figures_.anisotropy = OverRMax(differentials_.Anisotropy());
    figures_.nearest_distances = nearest_.ToCurve();
    if (figures_.mesh.has_value()) {
      figures_.mesh->angles = angles_.ToCurve();
      figures_.mesh->capacities = capacities_.ToCurve();
      figures_.mesh->valences = valences_.ToCurve(0.0);
    }
    return std::move(figures_);
  }

 private:
  bool Stopped() { return interrupt_ != nullptr && interrupt_->Requested(); }

  double DensityAt(const SurfacePoint& point) const {
    return reference_.density().At(point.face, point.weights);
  }

  void AddDistances(const std::vector<Eigen::Vector3d>& positions,
                    const std::vector<SurfacePoint>& points) {
    const Surface& surface = reference_.surface();
    std::vector<Eigen::Vector3d> normals;
    std::vector<double> scales;
    for (const SurfacePoint& point : points) {
      normals.push_back(surface.FaceCross(point.face).normalized());
      if (!reference_.density().uniform()) scales.push_back(1.0 / std::sqrt(DensityAt(point)));
    }
    const quality::DistanceFigures distances = quality::MeasureDistances(
        positions, normals, surface.area(), Eigen::Vector3d::Zero(), scales, parallel_, interrupt_);
    if (Stopped()) return;
    figures_.relative_radius += share_ * distances.relative_radius;
    figures_.relative_radius_same_side += share_ * distances.relative_radius_same_side;
    figures_.mean_nearest_distance += share_ * distances.mean_nearest_distance;
    for (const double distance : distances.nearest) nearest_.Add(distance);
  }

  // The density that each triangle's capacity counts with; empty where it is uniform.
  std::vector<double> DensitiesOf(std::span<const Eigen::Vector3i> triangles,
                                  const std::vector<SurfacePoint>& points) const {
    std::vector<double> densities;
    if (reference_.density().uniform()) return densities;
    for (const Eigen::Vector3i& t : triangles) {
      densities.push_back(
          (DensityAt(points[t[0]]) + DensityAt(points[t[1]]) + DensityAt(points[t[2]])) / 3.0);
    }
    return densities;
  }

  void AddMesh(const std::vector<Eigen::Vector3d>& positions,
               std::span<const Eigen::Vector3i> triangles,
               const std::vector<SurfacePoint>& points) {
    const bool first = !figures_.mesh.has_value();
    if (first) figures_.mesh = SampleFigures::Mesh();
    SampleFigures::Mesh& mesh = *figures_.mesh;
    const std::vector<double> densities = DensitiesOf(triangles, points);
    const quality::CapacityFigures capacity =
        quality::MeasureCapacities(positions, triangles, densities);
    mesh.capacity_cv += share_ * capacity.cv;
    mesh.voronoi_cv += share_ * quality::MeasureVoronoiVariation(positions, triangles, densities);
    mesh.bond_order += share_ * quality::MeasureBondOrder(positions, triangles);
    const quality::AngleFigures angles = quality::MeasureAngles(positions, triangles);
    mesh.smallest_angle = first ? angles.smallest : std::min(mesh.smallest_angle, angles.smallest);
    mesh.mean_smallest_angle += share_ * angles.mean_smallest;
    mesh.share_below_30 += share_ * angles.share_below_30;
    mesh.share_above_90 += share_ * angles.share_above_90;
    const quality::ShapeFigures shapes = quality::MeasureShapes(positions, triangles);
    mesh.q_min = first ? shapes.smallest : std::min(mesh.q_min, shapes.smallest);
    mesh.q_mean += share_ * shapes.mean;
    const quality::ValenceFigures valences =
        quality::MeasureValences(static_cast<std::int64_t>(positions.size()), triangles);
    mesh.valence_5_7 += share_ * valences.share_5_to_7;
    for (int k = 0; k < quality::ValenceFigures::kBins; ++k) {
      valences_.Add(k, static_cast<double>(valences.histogram[static_cast<std::size_t>(k)]));
    }
    for (int k = 0; k < quality::AngleFigures::kBins; ++k) {
      angles_.Add((k + 0.5) * quality::AngleFigures::kBinWidth,
                  static_cast<double>(angles.histogram[static_cast<std::size_t>(k)]));
    }
    AddCapacities(positions, triangles, densities, capacity.mean);
    if (!options_.surface_distance || Stopped()) return;
    const quality::SurfaceDistanceFigures distance = quality::MeasureSurfaceDistance(
        reference_.mesh(), reference_.tree(), positions, triangles, 0.0, parallel_);
    const double diagonal = reference_.surface().diagonal();
    mesh.hausdorff = mesh.hausdorff.value_or(0.0) + share_ * distance.hausdorff / diagonal;
    mesh.rms = mesh.rms.value_or(0.0) + share_ * distance.rms / diagonal;
  }

  void AddCapacities(const std::vector<Eigen::Vector3d>& positions,
                     std::span<const Eigen::Vector3i> triangles,
                     const std::vector<double>& densities, double mean) {
    if (!(mean > 0.0)) return;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Eigen::Vector3i& t = triangles[i];
      const Eigen::Vector3d u = positions[t[1]] - positions[t[0]];
      const Eigen::Vector3d v = positions[t[2]] - positions[t[0]];
      const double density = densities.empty() ? 1.0 : densities[i];
      capacities_.Add(0.5 * u.cross(v).norm() * density / mean);
    }
  }

  const ReferenceSurface& reference_;
  const FigureOptions options_;
  const Parallel& parallel_;
  Interrupt* const interrupt_;
  const double share_;
  Differentials differentials_;
  SampleFigures figures_;
  Histogram nearest_{0.02, 75};
  Histogram angles_{quality::AngleFigures::kBinWidth, quality::AngleFigures::kBins};
  Histogram capacities_{0.02, 100};
  Histogram valences_{1.0, quality::ValenceFigures::kBins};
};

}  // namespace

SampleFigures MeasureSamples(const ReferenceSurface& reference, std::span<const SampleSetView> sets,
                             const FigureOptions& options, const Parallel& parallel,
                             Interrupt* interrupt) {
  const auto count = static_cast<std::int64_t>(sets.front().positions.size());
  Sum sum(reference, options, parallel, interrupt, count, sets.size());
  for (const SampleSetView& set : sets) sum.Add(set);
  SampleFigures figures = std::move(sum).Finish();
  figures.count = count;
  figures.sets = static_cast<int>(sets.size());
  return figures;
}

}  // namespace ccst::analysis
