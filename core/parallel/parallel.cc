#include "core/parallel/parallel.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace ccst {

struct Parallel::Arena {
  tbb::task_arena arena;
};

Parallel::Parallel(int threads) {
  // More than the machine has gain nothing.
  threads = std::min(threads, tbb::info::default_concurrency());
  if (threads > 1) arena_ = std::make_unique<Arena>(Arena{tbb::task_arena(threads)});
}

Parallel::Parallel() = default;
Parallel::~Parallel() = default;

void Parallel::For(std::int64_t count, const std::function<void(std::int64_t)>& piece) const {
  if (arena_ == nullptr || count <= 1) {
    for (std::int64_t i = 0; i < count; ++i) piece(i);
    return;
  }
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::int64_t>(0, count, 1),
        [&](const tbb::blocked_range<std::int64_t>& range) {
          for (std::int64_t i = range.begin(); i < range.end(); ++i) piece(i);
        },
        tbb::simple_partitioner());
  });
}

}  // namespace ccst
