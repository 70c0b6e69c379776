#pragma once

namespace ccst {

/// What a geometry phase minimises.
enum class Energy {
  kTarget,       ///< sum_t (C_t - C*)^2, the variance about the fixed target.
  kSquaredArea,  ///< sum_t C_t^2, as printed in the paper; pulls samples off tips.
};

}  // namespace ccst
