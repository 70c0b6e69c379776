#pragma once

#include <optional>
#include <span>

#include "client/report/report.h"

namespace ccst::report {

/// A line of the table: a figure by its name.
struct FigureLine {
  enum class Best { kHighest, kLowest };
  const char* title;
  const char* format;  ///< Of printf, for a double.
  Best best;
  std::optional<double> (*value)(const Row&);
};

/// All lines, in their order.
std::span<const FigureLine> FigureLines();

/// Whether `row` has the best value of `line` among `rows`, of which several have one.
bool IsBest(const FigureLine& line, const Row& row, std::span<const Row> rows);

}  // namespace ccst::report
