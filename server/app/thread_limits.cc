#include "server/app/thread_limits.h"

#include <algorithm>
#include <climits>
#include <fstream>
#include <limits>
#include <thread>
#include <vector>

#include <malloc.h>
#include <pthread.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status.h"
#include "server/base/mutex.h"
#include "server/jobs/decoding_threads.h"

namespace ccst::server {
namespace {

// The backend's, the job manager's and the process's own: those of each kind are few and do not
// depend on the settings.
constexpr int kOwnThreads = 32;
constexpr int kMetricsThreads = 8;
// gRPC polls and runs callbacks on these, and makes more as work piles up, up to two a core.
constexpr int kGrpcThreads = 16;
constexpr int kMaxMoreGrpcThreads = 32;

int Cores() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

// The number in the file; empty for `max` and where there is none.
std::optional<std::int64_t> NumberIn(const std::string& path) {
  std::ifstream file(path);
  std::int64_t number = 0;
  if (file >> number) return number;
  return std::nullopt;
}

// Threads that wait until all are there.
class Crowd {
 public:
  ~Crowd() {
    {
      MutexLock lock(mutex_);
      may_go_ = true;
    }
    changed_.notify_all();
    for (const pthread_t thread : threads_) pthread_join(thread, nullptr);
  }

  // False where the system has no more.
  bool Add() {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    // What is looked for is a limit of threads, not of memory.
    pthread_attr_setstacksize(&attributes, std::max<std::size_t>(kStackBytes, PTHREAD_STACK_MIN));
    pthread_t thread = {};
    const int failed = pthread_create(&thread, &attributes, &Crowd::Wait, this);
    pthread_attr_destroy(&attributes);
    if (failed != 0) return false;
    threads_.push_back(thread);
    return true;
  }

  int size() const { return static_cast<int>(threads_.size()); }

 private:
  static constexpr std::size_t kStackBytes = 64 << 10;

  static void* Wait(void* self) {
    auto& crowd = *static_cast<Crowd*>(self);
    MutexLock lock(crowd.mutex_);
    while (!crowd.may_go_) crowd.changed_.wait(crowd.mutex_);
    return nullptr;
  }

  Mutex mutex_;
  CondVar changed_;
  bool may_go_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<pthread_t> threads_;
};

}  // namespace

int ThreadsOf(const ServerOptions& options) {
  const int jobs = options.runner.max_running_jobs;
  const int metrics = options.metrics_listen.empty() ? 0 : kMetricsThreads;
  // Shared by all jobs; see core/parallel.
  const int helpers = options.threads_per_job > 1 ? Cores() - 1 : 0;
  return kOwnThreads + metrics + kGrpcThreads + std::min(2 * Cores(), kMaxMoreGrpcThreads) +
         helpers + jobs + DecodingThreads(jobs);
}

int MaxRunningJobsWithin(ServerOptions options, int threads) {
  int jobs = std::min(threads, kMaxRunningJobs);
  for (; jobs > 0; --jobs) {
    options.runner.max_running_jobs = jobs;
    if (ThreadsOf(options) <= threads) break;
  }
  return jobs;
}

std::optional<std::int64_t> ThreadsLeftInControlGroup(const std::string& groups,
                                                      const std::string& root) {
  std::ifstream list(groups);
  std::optional<std::int64_t> left;
  // A line of version 2 is 0::PATH, one of version 1 NUMBER:CONTROLLERS:PATH.
  for (std::string line; std::getline(list, line);) {
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits(':', 2));
    if (parts.size() != 3 || !(parts[1].empty() || parts[1] == "pids")) continue;
    const std::string mount = parts[1].empty() ? root : root + "/pids";
    // Limits of the groups above hold too. In a container the path may lead out of what is seen.
    for (std::string path = parts[2];; path.erase(path.rfind('/'))) {
      const std::string group = path == "/" ? mount : mount + path;
      const auto limit = NumberIn(group + "/pids.max");
      const auto used = NumberIn(group + "/pids.current");
      if (limit.has_value()) {
        const std::int64_t here = std::max<std::int64_t>(0, *limit - used.value_or(0));
        left = std::min(left.value_or(here), here);
      }
      if (path.find('/') == std::string::npos) break;
    }
  }
  return left;
}

void ShareHeaps() { mallopt(M_ARENA_MAX, std::max(2, Cores())); }

absl::Status CheckThreads(int needed) {
  int started = 0;
  {
    Crowd crowd;
    while (crowd.size() < needed && crowd.Add()) continue;
    started = crowd.size();
  }
  if (started >= needed) return absl::OkStatus();
  const auto left = ThreadsLeftInControlGroup();
  return MakeError(
      absl::StatusCode::kResourceExhausted, ErrorReason::kOptionInvalid,
      absl::StrCat("the server may need ", needed, " threads, but the system lets it have ",
                   started, " more",
                   left.has_value() ? absl::StrCat(" (its control group has room for ", *left, ")")
                                    : std::string(),
                   "; raise the limit (ulimit -u, pids_limit of a container, TasksMax of a unit), "
                   "or lower --max-running-jobs"));
}

}  // namespace ccst::server
