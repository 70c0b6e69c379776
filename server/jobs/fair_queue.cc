#include "server/jobs/fair_queue.h"

#include <algorithm>
#include <utility>

namespace ccst::server {

std::size_t FairQueue::CountOf(const std::string& share) const {
  for (const Turn& turn : turns_) {
    if (turn.share == share) return turn.jobs.size();
  }
  return 0;
}

void FairQueue::Push(Entry entry) {
  const std::string& share = entry.job->spec().share;
  auto turn = std::find_if(turns_.begin(), turns_.end(),
                           [&](const Turn& other) { return other.share == share; });
  if (turn == turns_.end()) turn = turns_.insert(turns_.end(), {.share = share, .jobs = {}});
  turn->jobs.push_back(std::move(entry));
  ++size_;
}

bool FairQueue::Remove(const Job& job) {
  for (auto turn = turns_.begin(); turn != turns_.end(); ++turn) {
    const auto found = std::find_if(turn->jobs.begin(), turn->jobs.end(),
                                    [&](const Entry& entry) { return entry.job.get() == &job; });
    if (found == turn->jobs.end()) continue;
    turn->jobs.erase(found);
    if (turn->jobs.empty()) turns_.erase(turn);
    --size_;
    return true;
  }
  return false;
}

FairQueue::Entry FairQueue::Pop() {
  Turn& turn = turns_.front();
  Entry entry = std::move(turn.jobs.front());
  turn.jobs.pop_front();
  if (turn.jobs.empty()) {
    turns_.pop_front();
  } else {
    turns_.splice(turns_.end(), turns_, turns_.begin());
  }
  --size_;
  return entry;
}

std::vector<std::shared_ptr<Job>> FairQueue::Order() const {
  std::vector<std::shared_ptr<Job>> order;
  order.reserve(size_);
  for (std::size_t round = 0; order.size() < size_; ++round) {
    for (const Turn& turn : turns_) {
      if (round < turn.jobs.size()) order.push_back(turn.jobs[round].job);
    }
  }
  return order;
}

}  // namespace ccst::server
