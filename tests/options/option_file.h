#pragma once

#include <string>

namespace ccst {

/// Where the page's description of the options lies in the source tree.
inline constexpr char kOptionFile[] = "client/web/src/job/options.json";

/// What belongs into it: the options that the API takes, from the table of options, as JSON.
/// Numbers are in the users' units.
std::string OptionFileText();

}  // namespace ccst
