#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "core/density/density.h"
#include "core/sampling/sampling.h"
#include "core/surface/surface.h"

namespace ccst::paper {

/// Figures and curves of sets of samples on `surface` whose density is uniform, as JSON:
/// {radius, nearest, radial_mean{x,y}, anisotropy{x,y}} and, where the sets have sample meshes,
/// {cv, min_angle, below_30, valence_5_7, hausdorff}. See analysis::SampleFigures for what they
/// are.
nlohmann::json ReportFigures(const Surface& surface, std::span<const SampleSet> sets);

}  // namespace ccst::paper
