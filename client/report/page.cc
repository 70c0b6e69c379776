#include <cstdio>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "absl/strings/str_replace.h"
#include "client/report/figure_table.h"
#include "client/report/page_parts.h"
#include "client/report/report.h"

namespace ccst::report {
namespace {

using Json = nlohmann::ordered_json;

Json TableJson(std::span<const Row> rows) {
  Json table = Json::array();
  for (const FigureLine& line : FigureLines()) {
    Json cells = Json::array();
    for (const Row& row : rows) {
      const std::optional<double> value = line.value(row);
      if (!value.has_value()) {
        cells.push_back(nullptr);
        continue;
      }
      char text[64];
      std::snprintf(text, sizeof(text), line.format, *value);
      cells.push_back({{"text", text}, {"best", IsBest(line, row, rows)}});
    }
    table.push_back({{"title", line.title}, {"cells", cells}});
  }
  return table;
}

// As a value in a script: no text in it can end the script.
std::string InScript(const std::string& json) {
  return absl::StrReplaceAll(json, {{"<", "\\u003c"}});
}

}  // namespace

std::string ToPage(std::span<const Row> rows) {
  Json pictures = Json::array();
  for (const Row& row : rows) {
    pictures.push_back(row.picture.empty()
                           ? Json(nullptr)
                           : Json("data:image/png;base64," + absl::Base64Escape(row.picture)));
  }
  std::string page(kPageHtml);
  const auto fill = [&page](std::string_view mark, std::string_view text) {
    page.replace(page.find(mark), mark.size(), text);
  };
  const std::string json = ToJson(rows);
  fill("/*DATA*/", "const sets = [].concat(" + InScript(json) +
                       ");\nconst table = " + InScript(TableJson(rows).dump()) +
                       ";\nconst pictures = " + InScript(pictures.dump()) + ";");
  fill("/*PAGE*/", kPageScript);
  fill("/*CHART*/", kChartScript);
  return page;
}

}  // namespace ccst::report
