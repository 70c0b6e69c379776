#pragma once

namespace ccst::server {

/// Gives what was freed back to the system, where the allocator keeps it otherwise. Takes some
/// milliseconds for a few hundred MiB. Thread-safe.
void ReturnFreeMemory();

}  // namespace ccst::server
