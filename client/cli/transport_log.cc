#include "client/cli/transport_log.h"

#include <cstdio>

#include <grpc/support/log.h>

#include "core/base/printable_text.h"

namespace ccst::cli {
namespace {

constexpr std::size_t kMaxLineBytes = 1024;

// gRPC calls this for the severities that GRPC_VERBOSITY lets through, by default errors alone.
void Write(gpr_log_func_args* line) {
  std::fprintf(stderr, "ccst: transport: %s\n",
               PrintableExcerpt(line->message, kMaxLineBytes).c_str());
}

}  // namespace

void EscapeTransportErrors() { gpr_set_log_function(Write); }

}  // namespace ccst::cli
