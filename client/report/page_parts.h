#pragma once

#include <string_view>

/// Files that a page is made of, put into the program as it is built.
namespace ccst::report {

extern const std::string_view kPageHtml;     ///< page.html
extern const std::string_view kPageScript;   ///< page.js
extern const std::string_view kChartScript;  ///< Chart.js, as Debian packages it.

}  // namespace ccst::report
