#pragma once

#include "server/log/server_log.h"

namespace ccst::server {

/// From now on what the libraries have to say becomes lines like those of the server, on standard
/// error: errors of gRPC, such as a caller's refused certificate, and of protobuf, such as a
/// request that is no UTF-8. Anybody can cause them, so they are limited, see LimitedLog. Once a
/// process.
void LogLibraryErrors(LogFormat format);

/// Tells how many were left out; called now and then.
void TendLibraryLog();

}  // namespace ccst::server
