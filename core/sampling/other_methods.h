#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/options.h"
#include "core/sampling/relax/relaxation.h"
#include "core/sampling/run_control.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Draws samples by a method other than CCST; there is no triangulation over them. Steps of the
/// iterative methods are reported as alternations, with their own energy.
/// @param options  its method is not kCcst.
/// @param reserve  what the caller needs of the time until the deadline of `interrupt`: methods
/// that
///                 can end at any time end this much earlier.
/// @errors INVALID_ARGUMENT LIMIT_EXCEEDED more samples than the method takes; those of
///         Interrupt::Error() when `interrupt` was requested before there were samples.
absl::StatusOr<RelaxationReport> RunOtherMethod(
    const Surface& surface, const Density& density, const SamplingOptions& options,
    const std::function<void(const AlternationReport&)>& report, Interrupt* interrupt,
    Interrupt::Clock::duration reserve, Samples* samples);

}  // namespace ccst::internal
