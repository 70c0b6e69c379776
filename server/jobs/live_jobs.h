#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/mutex.h"
#include "server/jobs/job.h"

namespace ccst::server {

/// The jobs that are in memory: all whose end is not stored, and of the others those that somebody
/// looks at. Each id is one object, so that watchers and whoever cancels mean the same.
/// Thread-safe.
class LiveJobs {
 public:
  /// A job whose end is not stored.
  void Add(const std::shared_ptr<Job>& job);
  /// One that was not accepted, or that is left to the next start.
  void Remove(const std::string& id);
  /// Its end is stored.
  void SetStored(const std::shared_ptr<Job>& job);
  /// One that was stored, as it was read back; the object that is known already where there is one.
  std::shared_ptr<Job> AddStored(const std::shared_ptr<Job>& job);
  /// Its record is gone.
  void Forget(const std::string& id);

  /// Null when it is not in memory.
  std::shared_ptr<Job> Find(const std::string& id) const;
  /// Find() among those whose end is not stored.
  std::shared_ptr<Job> FindUnstored(const std::string& id) const;
  /// All whose end is not stored.
  std::vector<std::shared_ptr<Job>> Unstored() const;

  /// Gives back what is kept of jobs that nobody looks at any more; called now and then.
  void Tidy();

 private:
  mutable Mutex mutex_;
  std::map<std::string, std::shared_ptr<Job>> unstored_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, std::weak_ptr<Job>> stored_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
