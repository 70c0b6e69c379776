#include "server/net/descriptor_limit.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>

namespace ccst::server {
namespace {

FileDescriptor OpenNothing() { return FileDescriptor(open("/dev/null", O_RDONLY | O_CLOEXEC)); }

}  // namespace

std::int64_t RaiseDescriptorLimit() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
  if (limit.rlim_cur < limit.rlim_max) {
    const rlimit raised = {.rlim_cur = limit.rlim_max, .rlim_max = limit.rlim_max};
    if (setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  }
  return static_cast<std::int64_t>(limit.rlim_cur);
}

std::int64_t DescriptorLimit() {
  rlimit limit = {};
  return getrlimit(RLIMIT_NOFILE, &limit) == 0 ? static_cast<std::int64_t>(limit.rlim_cur) : 0;
}

SpareDescriptor::SpareDescriptor() : spare_(OpenNothing()) {}

void SpareDescriptor::TurnAway(int listening_socket) {
  spare_.Close();
  FileDescriptor(accept4(listening_socket, nullptr, nullptr, SOCK_CLOEXEC)).Close();
  spare_ = OpenNothing();
}

}  // namespace ccst::server
