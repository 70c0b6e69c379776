#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/analysis/curve.h"
#include "core/analysis/reference_surface.h"
#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"

namespace ccst::analysis {

/// A set of samples to be judged.
struct SampleSetView {
  std::span<const Eigen::Vector3d> positions;  ///< n x 3 [mesh unit], n > 0.
  std::span<const Eigen::Vector3i> triangles;  ///< m x 3, the sample mesh; may be empty.
};

/// Everything that is measured of samples. Lengths are over r_max, the spacing of a hexagonal
/// lattice of as many samples (where the density varies, the spacing it asks for), or where it says
/// so over the diagonal of the surface's bounding box. Figures of the sample mesh are empty where
/// there is none.
struct SampleFigures {
  std::int64_t count = 0;  ///< Samples of a set.
  int sets = 0;
  double relative_radius = 0.0;            ///< Smallest distance of all pairs.
  double relative_radius_same_side = 0.0;  ///< Of pairs with normals less than 90 degrees apart.
  double mean_nearest_distance = 0.0;
  double density_fidelity = 0.0;  ///< See MeasureDensityFidelity(): 0 is perfect.
  Curve radial_mean;              ///< x over r_max. See Differentials for these.
  Curve anisotropy;               ///< x over r_max, y in dB.
  Curve power_spectrum;           ///< x in units of sqrt(density).
  double effective_nyquist = 0.0;
  double oscillation = 0.0;
  Curve nearest_distances;  ///< Share of the samples by distance to the nearest, x over r_max.

  /// Of the sample meshes.
  struct Mesh {
    double capacity_cv = 0.0;
    double voronoi_cv = 0.0;
    double bond_order = 0.0;
    double smallest_angle = 0.0;       ///< [degree]
    double mean_smallest_angle = 0.0;  ///< [degree]
    double share_below_30 = 0.0;       ///< Of the angles, in [0, 1].
    double share_above_90 = 0.0;
    double q_min = 0.0;
    double q_mean = 0.0;
    double valence_5_7 = 0.0;         ///< Share in [0, 1].
    std::optional<double> hausdorff;  ///< Over the diagonal, as rms; see MeasureSurfaceDistance().
    std::optional<double> rms;
    Curve angles;      ///< Share of the angles [degree].
    Curve capacities;  ///< Share of the triangles by capacity over the mean.
    Curve valences;    ///< Share of the vertices off the boundary.
  };
  std::optional<Mesh> mesh;
};

/// What takes long and is not always wanted.
struct FigureOptions {
  bool surface_distance = true;
};

/// Measures `sets`, at least one, on `reference`: curves over the pairs of all sets, all other
/// figures means over the sets, but for smallest angle and q_min, which are the smallest. Sets
/// should have about equally many samples.
/// @param interrupt  polled between the steps, which take seconds on large surfaces; may be null.
///                   Once requested, what has not been measured yet is left out.
/// Cost about 3 s for a set of 1e5 samples and its mesh, 1 s without a mesh, 12 s on a surface of
/// 1.3 million faces; most of what the mesh adds is the surface distance. The same bits on any
/// number of threads.
SampleFigures MeasureSamples(const ReferenceSurface& reference, std::span<const SampleSetView> sets,
                             const FigureOptions& options = {},
                             const Parallel& parallel = Parallel(), Interrupt* interrupt = nullptr);

}  // namespace ccst::analysis
