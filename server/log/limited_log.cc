#include "server/log/limited_log.h"

#include <utility>

namespace ccst::server {
namespace {

constexpr double kWindowSeconds = 60.0;
constexpr std::int64_t kMaxMessages = 5;

}  // namespace

LimitedLog::LimitedLog(std::function<void(const std::string&)> say, std::function<double()> seconds)
    : say_(std::move(say)), seconds_(std::move(seconds)) {}

void LimitedLog::Message(const std::string& kind, const std::string& message) {
  MutexLock lock(mutex_);
  const double now = seconds_();
  const auto [it, is_new] = windows_.try_emplace(kind, Window{.start = now});
  Window& window = it->second;
  if (!is_new && now - window.start >= kWindowSeconds) {
    Close(kind, window);
    window = {.start = now};
  }
  if (++window.messages <= kMaxMessages) say_(message);
}

void LimitedLog::Tend() {
  MutexLock lock(mutex_);
  const double now = seconds_();
  std::erase_if(windows_, [&](const auto& entry) {
    if (now - entry.second.start < kWindowSeconds) return false;
    Close(entry.first, entry.second);
    return true;
  });
}

void LimitedLog::Close(const std::string& kind, const Window& window) const {
  const std::int64_t left_out = window.messages - kMaxMessages;
  if (left_out > 0) say_(kind + ": " + std::to_string(left_out) + " more within a minute");
}

}  // namespace ccst::server
