#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "server/jobs/job.h"

namespace ccst::server {

/// Jobs that wait: callers take turns, the jobs of one caller keep their order. Not thread-safe.
class FairQueue {
 public:
  /// A job and what it will need.
  struct Entry {
    std::shared_ptr<Job> job;
    std::int64_t memory_bytes = 0;
    bool alone = false;  ///< Nothing else may run beside it.
  };

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// Jobs of one caller.
  std::size_t CountOf(const std::string& share) const;

  void Push(Entry entry);
  /// False when it is not there.
  bool Remove(const Job& job);
  /// Whose turn it is; the queue must not be empty.
  const Entry& Front() const { return turns_.front().jobs.front(); }
  Entry Pop();
  /// In the order in which they will be popped. Cost O(size).
  std::vector<std::shared_ptr<Job>> Order() const;

 private:
  struct Turn {
    std::string share;
    std::deque<Entry> jobs;  // Never empty.
  };

  std::list<Turn> turns_;
  std::size_t size_ = 0;
};

}  // namespace ccst::server
