#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "core/base/interrupt.h"

namespace ccst {

/// Sorts [first, last) by `less`, a total order, in runs between which `interrupt` is looked at;
/// unfinished when it was requested. Cost O(n log n), about that of std::sort().
template <typename Iterator, typename Less = std::less<>>
void SortInRuns(Iterator first, Iterator last, Interrupt* interrupt, const Less& less = {}) {
  constexpr std::ptrdiff_t kRun = std::ptrdiff_t{1} << 17;
  const std::ptrdiff_t size = last - first;
  if (size <= kRun) return std::sort(first, last, less);
  const auto at = [&](std::ptrdiff_t i) { return first + std::min(i, size); };
  for (std::ptrdiff_t i = 0; i < size && !interrupt->Requested(); i += kRun) {
    std::sort(at(i), at(i + kRun), less);
  }
  for (std::ptrdiff_t run = kRun; run < size; run *= 2) {
    for (std::ptrdiff_t i = 0; i < size && !interrupt->Requested(); i += 2 * run) {
      std::inplace_merge(at(i), at(i + run), at(i + 2 * run), less);
    }
  }
}

}  // namespace ccst
