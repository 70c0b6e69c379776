#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/sampling/start/creases.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// One boundary loop or crease as a polyline with arc lengths, and where its samples start. Arc
/// lengths are weighed by the square root of the density, so that samples belong at equal
/// distances.
struct LoopPlan {
  std::vector<std::int32_t> half_edges;  ///< In walking order.
  std::int32_t component = 0;
  bool crease = false;
  bool open = false;          ///< A crease between two corners.
  bool closed = false;        ///< Too short for samples: closed in the sample mesh.
  std::vector<double> start;  ///< Arc length at which each of the loop's half-edges starts.
  std::vector<double> rate;   ///< Per half-edge: arc length a unit of length, sqrt(density).
  double length = 0.0;
  std::vector<double> arcs;         ///< Arc lengths of the samples, increasing.
  std::vector<std::uint8_t> fixed;  ///< Per sample: lies at a corner and stays there.
  double hole_capacity = 0.0;       ///< Capacity of the fan that closes it, when closed.

  /// The half-edge of the loop at `arc`, as an index into `start`.
  std::ptrdiff_t Segment(double arc) const;
};

/// How many samples go where.
struct ComponentPlan {
  std::int64_t samples = 0;  ///< Those on boundaries and creases included.
  std::int64_t boundary_samples = 0;
  std::int64_t crease_samples = 0;
  std::int64_t triangles = 0;  ///< Of the sample mesh.
  double target = 0.0;         ///< C*, the target capacity of a sample triangle.
  bool points = false;         ///< Too small for a triangulation: samples stay as they are drawn.
};

struct Plan {
  std::vector<ComponentPlan> components;
  std::vector<LoopPlan> loops;  ///< The boundary loops of the surface, then creases.
  /// r_max = sqrt(2 A / (sqrt(3) n)), the hexagonal spacing where the density is 1, its mean.
  double spacing = 0.0;
  std::int64_t closed_loops = 0;
  std::vector<std::int32_t> loop_order;  ///< Indices of the loops, component by component.
  std::vector<std::size_t> loop_starts;  ///< Per component, and the end: into loop_order.

  /// Indices of the loops of component `c`, increasing.
  std::span<const std::int32_t> LoopsOf(std::int32_t c) const {
    return std::span(loop_order).subspan(loop_starts[c], loop_starts[c + 1] - loop_starts[c]);
  }

  /// Hexagonal spacing where the density is `rho`.
  double LocalSpacing(double rho) const { return spacing / std::sqrt(rho); }
  /// Gives up the triangulation of component `c`; its samples stay as many.
  void MakePoints(std::int32_t c);
};

/// Shares `count` samples out over components by capacity (largest remainders) and over boundary
/// loops by spacing; corners of a loop (turning by more than 60 degrees) get a sample that stays.
/// Of several components those too small for a triangulation get points instead.
/// @param creases    lines to keep samples on; a sample stays at each of their corners.
/// @param smallest   set to the smallest larger count that may work when `count` is too small.
/// @param interrupt  may be null.
/// @errors INVALID_ARGUMENT COUNT_TOO_SMALL for the topology of the only component, or for the
///         length of its boundary and creases; those of Interrupt::Error().
/// Cost O((v + count) log v) time for v vertices on loops and creases, and O(v + count) memory
/// however long they are: samples are placed where their number was found to fit.
absl::StatusOr<Plan> MakePlan(const Surface& surface, const Density& density,
                              const std::vector<Crease>& creases, std::int64_t count,
                              std::uint64_t seed, std::int64_t* smallest,
                              Interrupt* interrupt = nullptr);

/// Point of loop `index` at arc length `arc` (taken modulo the length).
SurfacePoint PointOnLoop(const Surface& surface, const Plan& plan, std::int32_t index, double arc);

}  // namespace ccst::internal
