#pragma once

#include <cstdint>
#include <vector>

namespace ccst {

/// `count` shared out by `sizes` (not all zero): each its whole part, then one more by largest
/// remainder, the first of equal ones.
std::vector<std::int64_t> ShareOut(std::int64_t count, const std::vector<double>& sizes);

}  // namespace ccst
