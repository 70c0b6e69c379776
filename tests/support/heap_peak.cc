#include "tests/support/heap_peak.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

#include <malloc.h>

// glibc's own, below the ones that this file puts in front of them.
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* block, std::size_t size);             // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT
void __libc_free(void* block);                                   // NOLINT
}

namespace ccst {
namespace {

// Plain, so that counting works before any constructor has run.
std::atomic<std::int64_t> now_bytes{0};
std::atomic<std::int64_t> peak_bytes{0};

void* Counted(void* block) {
  if (block == nullptr) return block;
  const auto size = static_cast<std::int64_t>(malloc_usable_size(block));
  const std::int64_t now = now_bytes.fetch_add(size, std::memory_order_relaxed) + size;
  std::int64_t peak = peak_bytes.load(std::memory_order_relaxed);
  while (now > peak && !peak_bytes.compare_exchange_weak(peak, now, std::memory_order_relaxed)) {
  }
  return block;
}

void Uncount(void* block) {
  if (block == nullptr) return;
  now_bytes.fetch_sub(static_cast<std::int64_t>(malloc_usable_size(block)),
                      std::memory_order_relaxed);
}

}  // namespace

HeapUse CurrentHeapUse() { return {.now = now_bytes.load(), .peak = peak_bytes.load()}; }

void ResetHeapPeak() { peak_bytes = now_bytes.load(); }

}  // namespace ccst

extern "C" {

void* malloc(std::size_t size) { return ccst::Counted(__libc_malloc(size)); }

void* calloc(std::size_t count, std::size_t size) {
  return ccst::Counted(__libc_calloc(count, size));
}

void* realloc(void* block, std::size_t size) {
  // While it moves both are there; what was there before counts until then.
  const std::size_t before = block == nullptr ? 0 : malloc_usable_size(block);
  void* const moved = __libc_realloc(block, size);
  if (moved == nullptr && size != 0) return nullptr;
  ccst::Counted(moved);
  ccst::now_bytes.fetch_sub(static_cast<std::int64_t>(before), std::memory_order_relaxed);
  return moved;
}

void free(void* block) {
  ccst::Uncount(block);
  __libc_free(block);
}

void* memalign(std::size_t alignment, std::size_t size) {
  return ccst::Counted(__libc_memalign(alignment, size));
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

}  // extern "C"
