#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>

namespace ccst {

/// Runs independent pieces of work on several threads. Which thread runs which piece, and when, is
/// left open: a piece must not write what another one reads, and what pieces return is put together
/// in the order of their numbers. Then results do not depend on the number of threads.
class Parallel {
 public:
  /// On one thread, the caller's.
  Parallel();
  /// @param threads  >= 1, the caller's among them; no more than the machine has processors.
  explicit Parallel(int threads);
  ~Parallel();
  Parallel(const Parallel&) = delete;
  Parallel& operator=(const Parallel&) = delete;

  /// Calls `piece(i)` once for each i in [0, count) and returns when all have returned.
  void For(std::int64_t count, const std::function<void(std::int64_t)>& piece) const;

  /// Calls `range(first, end)` for ranges that make up [0, count), each of `size` numbers but the
  /// last: where they are cut does not depend on the number of threads.
  template <typename Range>
  void ForRanges(std::int64_t count, std::int64_t size, const Range& range) const {
    For((count + size - 1) / size,
        [&](std::int64_t piece) { range(piece * size, std::min(count, (piece + 1) * size)); });
  }

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;  // Null for one thread.
};

}  // namespace ccst
