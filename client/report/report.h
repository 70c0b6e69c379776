#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/analysis/sample_figures.h"

namespace ccst::report {

/// Samples of one kind and what was measured of them.
struct Row {
  std::string name;
  std::int64_t count = 0;
  std::optional<analysis::SampleFigures> figures;  ///< Empty where no surface was known.
  std::string picture;                             ///< PNG; may be empty.
};

/// One JSON object a row, with the keys of the command's contract; several rows are an array. What
/// could not be computed is null.
std::string ToJson(std::span<const Row> rows);

/// The figures as a table for a terminal, a column a row, the best of each line marked.
std::string ToText(std::span<const Row> rows);

/// One page for people, all in one file: the table, curves and histograms side by side, the
/// pictures. Opens without a network.
std::string ToPage(std::span<const Row> rows);

}  // namespace ccst::report
