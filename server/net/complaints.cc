#include "server/net/complaints.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace ccst::server {

Complaints::Complaints(std::function<void(std::string_view reason)> count,
                       std::function<void(const std::string& line)> report)
    : count_(std::move(count)), report_(std::move(report)) {}

void Complaints::Note(std::string_view reason, std::string_view detail, double now) {
  count_(reason);
  std::string line =
      absl::StrCat("connection refused: ", absl::string_view(detail.data(), detail.size()));
  {
    const MutexLock lock(mutex_);
    auto found = kinds_.find(reason);
    if (found == kinds_.end()) found = kinds_.emplace(std::string(reason), Kind{}).first;
    Kind& kind = found->second;
    if (now < kind.next_line) {
      ++kind.untold;
      return;
    }
    if (kind.untold > 0) absl::StrAppend(&line, " (and ", kind.untold, " like it before)");
    kind = {.next_line = now + kInterval};
  }
  report_(line);
}

}  // namespace ccst::server
