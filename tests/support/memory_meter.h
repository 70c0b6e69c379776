#pragma once

#include <cstdint>

namespace ccst::test {

/// Counts the bytes that `new` hands out in the whole program that links this, and may refuse more.
/// Memory taken with malloc() is not seen; the core takes none so. One at a time.
class MemoryMeter {
 public:
  /// From now on whoever asks for more than `limit` bytes at once over what is in use now gets
  /// std::bad_alloc.
  explicit MemoryMeter(std::int64_t limit);
  ~MemoryMeter();
  MemoryMeter(const MemoryMeter&) = delete;
  MemoryMeter& operator=(const MemoryMeter&) = delete;

  /// The most in use since it was made, over what was in use then.
  std::int64_t PeakBytes() const;

 private:
  const std::int64_t before_;
};

}  // namespace ccst::test
