#pragma once

#include <vector>

namespace ccst::analysis {

/// A function of one variable at some places.
struct Curve {
  std::vector<double> x;  ///< Strictly increasing.
  std::vector<double> y;  ///< As many.
};

}  // namespace ccst::analysis
