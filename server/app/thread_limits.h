#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "server/app/server_options.h"

namespace ccst::server {

/// Threads that a server with `options` may have at once, its libraries' among them.
int ThreadsOf(const ServerOptions& options);

/// As many jobs as may run at once so that ThreadsOf() is at most `threads`; 0 where none may.
int MaxRunningJobsWithin(ServerOptions options, int threads);

/// How many more processes and threads the control groups of this process allow, empty where there
/// is no limit: what a container's pids limit or a unit's TasksMax has become.
/// @param groups  the list of the process's groups, /proc/self/cgroup
/// @param root    where control groups are mounted, /sys/fs/cgroup
std::optional<std::int64_t> ThreadsLeftInControlGroup(
    const std::string& groups = "/proc/self/cgroup", const std::string& root = "/sys/fs/cgroup");

/// Lets all threads share one heap a core, to be called before there are any. By default the C
/// library gives each thread a heap of its own, up to eight a core: address space that a limit
/// (ulimit -v) may not have, and memory that one thread has freed and no other can use.
void ShareHeaps();

/// Starts `needed` threads for a moment, which shows whether every limit there is allows them. A
/// server that cannot have its threads would hang or break where it needs one.
/// @errors RESOURCE_EXHAUSTED  says how many there can be, which limits there are, and what to do
absl::Status CheckThreads(int needed);

}  // namespace ccst::server
