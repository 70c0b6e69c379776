#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/sampling/relaxation.h"
#include "core/sampling/samples.h"
#include "core/sampling/sampling.h"
#include "core/surface/surface.h"

namespace ccst {

/// Draws samples by a method other than CCST; there is no triangulation over them. Steps of the
/// iterative methods are reported as alternations, with their own energy.
/// @param options  its method is not kCcst.
/// @errors INVALID_ARGUMENT LIMIT_EXCEEDED more samples than the method takes; CANCELLED when
///         `interrupt` was requested before there were samples.
absl::StatusOr<RelaxationReport> RunOtherMethod(
    const Surface& surface, const Density& density, const SamplingOptions& options,
    const std::function<void(const AlternationReport&)>& report, Interrupt* interrupt,
    Samples* samples);

}  // namespace ccst
