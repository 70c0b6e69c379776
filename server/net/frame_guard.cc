#include "server/net/frame_guard.h"

#include <algorithm>
#include <utility>

namespace ccst::server {
namespace {

// RFC 9113, sections 3.4, 4.1 and 6.
constexpr std::string_view kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
enum FrameType {
  kData = 0,
  kHeaders = 1,
  kPriority = 2,
  kReset = 3,
  kSettings = 4,
  kPushPromise = 5,
  kPing = 6,
  kGoAway = 7,
  kWindowUpdate = 8,
  kContinuation = 9,
};
constexpr int kEndStream = 0x1;
constexpr int kEndHeaders = 0x4;
constexpr std::uint32_t kStreamMask = 0x7fffffff;
// DATA with less than this in it is all overhead.
constexpr std::size_t kTinyData = 64;

}  // namespace

std::optional<FrameHead> FrameCursor::Next(std::span<const char> bytes, std::size_t& at) {
  while (at < bytes.size()) {
    if (payload_left_ > 0) {
      const std::size_t skipped = std::min(payload_left_, bytes.size() - at);
      payload_left_ -= skipped;
      at += skipped;
      continue;
    }
    head_[head_size_++] = static_cast<unsigned char>(bytes[at++]);
    if (head_size_ < kHeadBytes) continue;
    head_size_ = 0;
    const auto number = [this](std::size_t first, std::size_t count) {
      std::uint32_t value = 0;
      for (std::size_t i = first; i < first + count; ++i) value = value << 8 | head_[i];
      return value;
    };
    payload_left_ = number(0, 3);
    return FrameHead{.length = payload_left_,
                     .type = head_[3],
                     .flags = head_[4],
                     .stream = number(5, 4) & kStreamMask};
  }
  return std::nullopt;
}

FrameGuard::FrameGuard(std::function<double(double now)> take_reset)
    : take_reset_(std::move(take_reset)),
      resets_(kResetsPerSecond, kResetBurst),
      controls_(kControlsPerSecond, kControlBurst),
      frames_(kFramesPerSecond, kFrameBurst) {}

FrameGuard::Verdict FrameGuard::Inspect(std::span<const char> bytes, double now) {
  if (bytes.empty()) return {.allowed = 0, .resume_at = now};
  if (held_until_ > now) return {.allowed = 0, .resume_at = held_until_};
  std::size_t at = std::exchange(holds_byte_, false) ? 1 : 0;
  while (preface_size_ < kPreface.size() && at < bytes.size()) {
    if (bytes[at++] != kPreface[preface_size_++]) return {.offence = "no HTTP/2"};
  }
  while (const auto head = requests_.Next(bytes, at)) {
    has_begun_ = true;
    const std::string_view offence = Judge(*head, now);
    if (!offence.empty()) return {.offence = offence};
    if (held_until_ <= now) continue;
    holds_byte_ = true;
    return {.allowed = at - 1, .resume_at = held_until_};
  }
  return {.allowed = at, .resume_at = now};
}

std::string_view FrameGuard::Judge(const FrameHead& head, double now) {
  if (head.type == kHeaders || head.type == kContinuation || open_block_ != 0) {
    HoldUntil(frames_.Take(now));
    return JudgeHeaders(head);
  }
  switch (head.type) {
    case kData:
      if (head.length == 0 && (head.flags & kEndStream) == 0) {
        HoldUntil(controls_.Take(now));
      } else if (head.length < kTinyData) {
        HoldUntil(frames_.Take(now));
      }
      break;
    case kReset:
      CountReset(now);
      break;
    case kWindowUpdate:
      HoldUntil(frames_.Take(now));
      break;
    case kPushPromise:
      return "a promise from a client";
    case kPriority:
    case kSettings:
    case kPing:
    case kGoAway:
    default:
      HoldUntil(controls_.Take(now));
  }
  return {};
}

std::string_view FrameGuard::JudgeHeaders(const FrameHead& head) {
  const bool goes_on = open_block_ != 0;
  if (goes_on != (head.type == kContinuation) || (goes_on && head.stream != open_block_)) {
    return "a block of headers that another frame interrupts";
  }
  if (!goes_on) {
    has_requests_ = true;
    block_bytes_ = 0;
    block_frames_ = 0;
  }
  block_bytes_ += head.length;
  if (++block_frames_ > kMaxHeaderFrames || block_bytes_ > kMaxHeaderBytes) {
    return "an endless block of headers";
  }
  open_block_ = (head.flags & kEndHeaders) != 0 ? 0 : head.stream;
  return {};
}

void FrameGuard::InspectAnswer(std::span<const char> bytes, double now) {
  std::size_t at = 0;
  while (const auto head = answers_.Next(bytes, at)) {
    if (head->type == kReset) CountReset(now);
  }
}

void FrameGuard::CountReset(double now) {
  HoldUntil(resets_.Take(now));
  if (take_reset_) HoldUntil(take_reset_(now));
}

}  // namespace ccst::server
