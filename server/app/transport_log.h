#pragma once

#include "server/log/server_log.h"

namespace ccst::server {

/// From now on errors of gRPC itself, such as a caller's refused certificate, become lines like
/// those of the server, on standard error. Once a process.
void LogTransportErrors(LogFormat format);

}  // namespace ccst::server
