#pragma once

#include <variant>

#include "server/app/server_options.h"

namespace ccst::server {

/// Nothing to serve: what was asked for was printed, or what is wrong.
struct Done {
  int exit_code = 0;  ///< 0, or 1 for a wrong setting.
};

/// The options of a server: each from its flag, else from CCST_<FLAG>, else from the file that
/// --config names, else its default. All of them are valid; the files they name are not read but
/// for --check-config.
std::variant<Done, ServerOptions> ParseCommandLine(int argc, const char* const* argv);

}  // namespace ccst::server
