#include "tests/support/memory_meter.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>

#include <malloc.h>

namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

std::atomic<std::int64_t> in_use = 0;
std::atomic<std::int64_t> peak = 0;
std::atomic<std::int64_t> most = kNoLimit;

void* Take(std::size_t size, std::size_t alignment) {
  if (static_cast<std::int64_t>(size) > most - in_use) return nullptr;
  // aligned_alloc() wants whole multiples.
  void* place = alignment <= alignof(std::max_align_t)
                    ? std::malloc(size > 0 ? size : 1)
                    : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (place == nullptr) return nullptr;
  const auto taken = static_cast<std::int64_t>(malloc_usable_size(place));
  const std::int64_t now = in_use.fetch_add(taken) + taken;
  std::int64_t highest = peak;
  while (now > highest && !peak.compare_exchange_weak(highest, now)) {
  }
  return place;
}

void* TakeOrThrow(std::size_t size, std::size_t alignment) {
  void* place = Take(size, alignment);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}

void Return(void* place) noexcept {
  if (place == nullptr) return;
  in_use -= static_cast<std::int64_t>(malloc_usable_size(place));
  std::free(place);
}

}  // namespace

// The arrays' and the other forms of these call them.
void* operator new(std::size_t size) { return TakeOrThrow(size, 1); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return TakeOrThrow(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* place) noexcept { Return(place); }
void operator delete(void* place, std::size_t) noexcept { Return(place); }
void operator delete(void* place, std::align_val_t) noexcept { Return(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { Return(place); }

namespace ccst::test {

MemoryMeter::MemoryMeter(std::int64_t limit) : before_(in_use) {
  peak = before_;
  most = limit < kNoLimit - before_ ? before_ + limit : kNoLimit;
}

MemoryMeter::~MemoryMeter() { most = kNoLimit; }

std::int64_t MemoryMeter::PeakBytes() const { return peak - before_; }

}  // namespace ccst::test
