#pragma once

namespace ccst::cli {

/// From now on errors of gRPC itself reach standard error as a line each without control
/// characters: they may hold what a server sent. Once a process.
void EscapeTransportErrors();

}  // namespace ccst::cli
