#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/mesh/triangle_mesh.h"
#include "core/repair/repair_report.h"

namespace ccst {

/// Why a run ended by itself or was ended.
enum class Termination { kConverged, kIterationLimit, kTimeLimit, kStopped };

/// Facts about the surface that was sampled.
struct SurfaceSummary {
  std::int64_t vertices = 0;  ///< After repair, as all of the following.
  std::int64_t faces = 0;
  double area = 0.0;      ///< [mesh unit^2]
  double diagonal = 0.0;  ///< Of the bounding box [mesh unit].
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  std::int64_t creases = 0;  ///< Lines between corners that samples were kept on.
  std::int64_t euler = 0;    ///< V - E + F.
  std::int64_t closed_loops =
      0;  ///< Boundary loops too short for samples, closed in the sample mesh.
  /// Components too small for a triangulation at this sample_count, and how many samples lie on
  /// them: placed by capacity, in no sample triangle.
  std::int64_t untriangulated_components = 0;
  std::int64_t untriangulated_samples = 0;
  RepairReport repairs;  ///< What it took to make a surface of the input.
};

/// n samples and the triangulation over them. Arrays are parallel. Every prefix is well spread.
struct SampleSet {
  std::vector<std::int32_t> faces;            ///< n: host face, an index into the input's faces.
  std::vector<Eigen::Vector2d> barycentrics;  ///< n: weights of the host's corners 0 and 1, >= 0,
                                              ///< sum <= 1. Exact: positions derive from these.
  std::vector<Eigen::Vector3d> positions;     ///< n x 3 on the surface [mesh unit].
  std::vector<Eigen::Vector3d> normals;       ///< n x 3 unit, interpolated over the host.
  std::vector<Eigen::Vector3i> triangles;     ///< m x 3 indices of samples; the sample mesh.
  std::vector<Attribute> attributes = {};     ///< n x K each; see InterpolateAttributes().
  /// n x 3: which corners of the face, counted from 0, the barycentrics belong to, where `faces`
  /// are polygons of a file; empty where they are triangles.
  std::vector<Eigen::Vector3i> face_corners = {};
};

/// What SampleSurface() returns.
struct SamplingResult {
  SampleSet samples;
  SurfaceSummary surface;
  Termination termination = Termination::kConverged;
  int alternations = 0;
  std::int64_t passes = 0;  ///< Sweeps over all samples, summed over the alternations.
  double energy = 0.0;      ///< As in AlternationReport.
  double capacity_cv = 0.0;
  double relative_radius = 0.0;  ///< d_min / r_max between samples on the same side, distances
                                 ///< in units of the spacing that the density asks for there; 0
                                 ///< where the run was ended before it was measured.
  double prepare_seconds = 0.0;
  double initialise_seconds = 0.0;
  double optimise_seconds = 0.0;
};

}  // namespace ccst
