#pragma once

#include <cstdint>

namespace ccst {

/// Bytes of the heap that are in use, and the most since ResetHeapPeak(). Programs that link
/// heap_peak.cc count every malloc, new and the like of all their libraries, by usable size.
struct HeapUse {
  std::int64_t now = 0;
  std::int64_t peak = 0;
};
HeapUse CurrentHeapUse();

/// The peak becomes what is in use now.
void ResetHeapPeak();

}  // namespace ccst
