#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "core/base/printable_text.h"

namespace ccst::cli {

/// `json` as people and programs read it: indented by two spaces, with a line end. Strings may hold
/// what others chose, also bytes that are no UTF-8: no terminal obeys them, see PrintableText(),
/// whose escapes are those of JSON.
inline std::string JsonText(const nlohmann::ordered_json& json) {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  return PrintableText(json.dump(2, ' ', false, kReplace), "\n") + "\n";
}

}  // namespace ccst::cli
