#include "core/spatial/spatial_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "core/base/sort_in_runs.h"
#include "core/spatial/hilbert.h"

namespace ccst {
namespace {

/// Leading bits of the 48 of a key by which points are dealt out before they are sorted, so that
/// no sort is long.
constexpr int kLeadingBits = 15;

/// Points or buckets that one thread works on in one go.
constexpr std::int64_t kPiece = 8192;
constexpr std::int64_t kBuckets = 1024;

std::uint64_t KeyOf(const Eigen::Vector3d& position) {
  std::array<std::uint32_t, 3> cell;
  for (int k = 0; k < 3; ++k) {
    cell[k] = static_cast<std::uint32_t>(std::clamp((position[k] + 0.5) * 65535.0, 0.0, 65535.0));
  }
  return HilbertIndex(cell);
}

}  // namespace

std::vector<std::int32_t> HilbertOrder(const std::vector<Eigen::Vector3d>& positions,
                                       Interrupt* interrupt, const Parallel& parallel) {
  const std::size_t n = positions.size();
  std::vector<std::uint64_t> keys(n);
  parallel.ForRanges(static_cast<std::int64_t>(n), kPiece,
                     [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
                       if (Interrupt(stop).Requested()) return;
                       for (auto i = static_cast<std::size_t>(first);
                            i < static_cast<std::size_t>(end); ++i) {
                         keys[i] = KeyOf(positions[i]);
                       }
                     });
  if (interrupt->Requested()) return {};
  std::vector<std::size_t> ends((std::size_t{1} << kLeadingBits) + 1, 0);
  for (const std::uint64_t key : keys) ++ends[(key >> (48 - kLeadingBits)) + 1];
  for (std::size_t b = 1; b < ends.size(); ++b) ends[b] += ends[b - 1];
  // ends[b] is where bucket b begins until its points are dealt out, and where it ends after that.
  std::vector<std::pair<std::uint64_t, std::int32_t>> sorted(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(i))) return {};
    sorted[ends[keys[i] >> (48 - kLeadingBits)]++] = {keys[i], static_cast<std::int32_t>(i)};
  }
  std::vector<std::int32_t> order(n);
  parallel.ForRanges(static_cast<std::int64_t>(ends.size()) - 1, kBuckets,
                     [&, stop = *interrupt](std::int64_t first, std::int64_t last) {
                       for (std::int64_t b = first; b < last; ++b) {
                         const auto begin = static_cast<std::ptrdiff_t>(b == 0 ? 0 : ends[b - 1]);
                         const auto end = static_cast<std::ptrdiff_t>(ends[b]);
                         Interrupt own = stop;
                         if (end - begin > 1 && own.Requested()) return;
                         SortInRuns(sorted.begin() + begin, sorted.begin() + end, &own);
                         for (std::ptrdiff_t k = begin; k < end; ++k) {
                           order[k] = sorted[static_cast<std::size_t>(k)].second;
                         }
                       }
                     });
  if (interrupt->Requested()) return {};
  return order;
}

}  // namespace ccst
