#include "server/app/library_log.h"

#include <cstdlib>
#include <string>

#include <google/protobuf/stubs/logging.h>
#include <grpc/support/log.h>

#include "absl/strings/str_cat.h"
#include "server/app/system.h"
#include "server/log/limited_log.h"

namespace ccst::server {
namespace {

// The hooks take no context, and may be called until the process is gone.
struct LibraryLog {
  explicit LibraryLog(LogFormat format) : log(format, SystemClock().now, WriteToStandardError) {}

  ServerLog log;
  LimitedLog limited{[this](const std::string& message) { log.Message(message); },
                     SystemClock().seconds};
};

LibraryLog* library_log = nullptr;

void WriteGrpc(gpr_log_func_args* line) {
  // What gRPC says when it is told to say more may hold what callers sent.
  if (line->severity < GPR_LOG_SEVERITY_ERROR) return;
  // A kind is a place in gRPC's sources.
  library_log->limited.Message(absl::StrCat("transport: ", line->file, ":", line->line),
                               absl::StrCat("transport: ", line->message));
}

void WriteProtobuf(google::protobuf::LogLevel level, const char* file, int line,
                   const std::string& message) {
  const std::string text = absl::StrCat("messages: ", message);
  if (level == google::protobuf::LOGLEVEL_FATAL) {
    library_log->log.Message(text);  // The last words of the process.
  } else if (level == google::protobuf::LOGLEVEL_ERROR) {
    library_log->limited.Message(absl::StrCat("messages: ", file, ":", line), text);
  }
}

}  // namespace

void LogLibraryErrors(LogFormat format) {
  library_log = new LibraryLog(format);
  gpr_set_log_function(WriteGrpc);
  google::protobuf::SetLogHandler(WriteProtobuf);
}

void TendLibraryLog() {
  if (library_log != nullptr) library_log->limited.Tend();
}

}  // namespace ccst::server
