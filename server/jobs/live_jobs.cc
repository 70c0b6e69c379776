#include "server/jobs/live_jobs.h"

namespace ccst::server {

void LiveJobs::Add(const std::shared_ptr<Job>& job) {
  MutexLock lock(mutex_);
  unstored_[job->id()] = job;
}

void LiveJobs::Remove(const std::string& id) {
  MutexLock lock(mutex_);
  unstored_.erase(id);
}

void LiveJobs::SetStored(const std::shared_ptr<Job>& job) {
  MutexLock lock(mutex_);
  // Unless it was deleted since its end is stored.
  if (unstored_.erase(job->id()) > 0) stored_[job->id()] = job;
}

std::shared_ptr<Job> LiveJobs::AddStored(const std::shared_ptr<Job>& job) {
  MutexLock lock(mutex_);
  std::weak_ptr<Job>& known = stored_[job->id()];
  if (auto other = known.lock()) return other;
  known = job;
  return job;
}

void LiveJobs::Forget(const std::string& id) {
  MutexLock lock(mutex_);
  unstored_.erase(id);
  stored_.erase(id);
}

std::shared_ptr<Job> LiveJobs::Find(const std::string& id) const {
  MutexLock lock(mutex_);
  if (const auto found = unstored_.find(id); found != unstored_.end()) return found->second;
  const auto found = stored_.find(id);
  return found != stored_.end() ? found->second.lock() : nullptr;
}

std::shared_ptr<Job> LiveJobs::FindUnstored(const std::string& id) const {
  MutexLock lock(mutex_);
  const auto found = unstored_.find(id);
  return found != unstored_.end() ? found->second : nullptr;
}

std::vector<std::shared_ptr<Job>> LiveJobs::Unstored() const {
  MutexLock lock(mutex_);
  std::vector<std::shared_ptr<Job>> jobs;
  for (const auto& [id, job] : unstored_) jobs.push_back(job);
  return jobs;
}

void LiveJobs::Tidy() {
  MutexLock lock(mutex_);
  std::erase_if(stored_, [](const auto& entry) { return entry.second.expired(); });
}

}  // namespace ccst::server
