#include "server/app/transport_log.h"

#include <string>

#include <grpc/support/log.h>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "server/app/system.h"

namespace ccst::server {
namespace {

// gRPC's hook takes no context, and may be called until the process is gone.
ServerLog* transport_log = nullptr;

void Write(gpr_log_func_args* line) {
  // What gRPC says when it is told to say more may hold what callers sent.
  if (line->severity < GPR_LOG_SEVERITY_ERROR) return;
  std::string message = absl::StrCat("transport: ", line->message);
  for (char& c : message) {
    if (!absl::ascii_isprint(static_cast<unsigned char>(c))) c = ' ';
  }
  absl::StripTrailingAsciiWhitespace(&message);
  transport_log->Message(message);
}

}  // namespace

void LogTransportErrors(LogFormat format) {
  transport_log = new ServerLog(format, SystemClock().now, WriteToStandardError);
  gpr_set_log_function(Write);
}

}  // namespace ccst::server
