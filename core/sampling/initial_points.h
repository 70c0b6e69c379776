#pragma once

#include <cstdint>

#include "core/sampling/plan.h"
#include "core/sampling/samples.h"
#include "core/surface/surface.h"

namespace ccst {

/// Draws the initial samples: boundary samples where the plan puts them, then interior ones
/// uniformly by area. The area is cut into as many equal strata as there are samples, along a
/// Hilbert curve over the faces and a quadtree inside each, with one sample drawn in each stratum:
/// every region gets its share from the start, and neighbours in memory are neighbours in space.
/// On a component that gets points all are drawn at the same place of their strata, which keeps
/// them apart. Samples are ordered by component; within one, interior ones along the curve, then
/// boundary ones loop by loop.
Samples DrawInitialPoints(const Surface& surface, const Plan& plan, std::uint64_t seed);

/// Weights of the point at `t` in [0, 1) of a space-filling order of a triangle that preserves
/// area: base-4 digits choose one of four congruent parts.
/// Source: Basu and Owen, "Low discrepancy constructions in the triangle", SINUM 53(2), 2015.
Eigen::Vector3d TriangleCurve(double t);

}  // namespace ccst
