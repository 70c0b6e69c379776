#pragma once

#include <cstdint>

#include "server/net/file_descriptor.h"

namespace ccst::server {

/// Raises the number of descriptors that this process may have open to all that the system lets it
/// have: the usual soft limit of 1024 is for programs that use select(). Returns what it is now.
std::int64_t RaiseDescriptorLimit();

/// How many descriptors this process may have open.
std::int64_t DescriptorLimit();

/// A descriptor that is kept for the moment when there are no others: a connection that nobody
/// accepts stays in the kernel's queue and wakes who listens again and again.
class SpareDescriptor {
 public:
  SpareDescriptor();
  /// Accepts one connection of the listening socket in the spare one's place and closes it.
  void TurnAway(int listening_socket);

 private:
  FileDescriptor spare_;
};

}  // namespace ccst::server
