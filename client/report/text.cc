#include <algorithm>
#include <cstdio>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/report/figure_table.h"
#include "client/report/report.h"

namespace ccst::report {
namespace {

std::string Cell(const FigureLine& line, const Row& row, std::span<const Row> rows) {
  const std::optional<double> value = line.value(row);
  if (!value.has_value()) return "-";
  char text[64];
  std::snprintf(text, sizeof(text), line.format, *value);
  return std::string(text) + (IsBest(line, row, rows) ? " *" : "  ");
}

}  // namespace

std::string ToText(std::span<const Row> rows) {
  constexpr int kTitleWidth = 34;
  std::string text = absl::StrFormat("%-*s", kTitleWidth, "");
  std::vector<int> widths;
  for (const Row& row : rows) {
    widths.push_back(std::max(12, static_cast<int>(row.name.size()) + 2));
    absl::StrAppendFormat(&text, "%*s", widths.back(), row.name);
  }
  absl::StrAppendFormat(&text, "\n%-*s", kTitleWidth, "samples");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    absl::StrAppendFormat(&text, "%*d  ", widths[i] - 2, rows[i].count);
  }
  text += "\n";
  for (const FigureLine& line : FigureLines()) {
    absl::StrAppendFormat(&text, "%-*s", kTitleWidth, line.title);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      absl::StrAppendFormat(&text, "%*s", widths[i], Cell(line, rows[i], rows));
    }
    text += "\n";
  }
  return text;
}

}  // namespace ccst::report
