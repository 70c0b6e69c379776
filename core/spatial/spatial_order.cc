#include "core/spatial/spatial_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "core/spatial/hilbert.h"

namespace ccst {
namespace {

/// Leading bits of the 48 of a key by which points are dealt out before they are sorted, so that
/// no sort is long.
constexpr int kLeadingBits = 15;

std::uint64_t KeyOf(const Eigen::Vector3d& position) {
  std::array<std::uint32_t, 3> cell;
  for (int k = 0; k < 3; ++k) {
    cell[k] = static_cast<std::uint32_t>(std::clamp((position[k] + 0.5) * 65535.0, 0.0, 65535.0));
  }
  return HilbertIndex(cell);
}

}  // namespace

std::vector<std::int32_t> HilbertOrder(const std::vector<Eigen::Vector3d>& positions,
                                       Interrupt* interrupt) {
  const std::size_t n = positions.size();
  std::vector<std::uint64_t> keys(n);
  std::vector<std::size_t> ends((std::size_t{1} << kLeadingBits) + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    if (interrupt->RequestedAt(static_cast<std::int64_t>(i))) return {};
    keys[i] = KeyOf(positions[i]);
    ++ends[(keys[i] >> (48 - kLeadingBits)) + 1];
  }
  for (std::size_t b = 1; b < ends.size(); ++b) ends[b] += ends[b - 1];
  // ends[b] is where bucket b begins until its points are dealt out, and where it ends after that.
  std::vector<std::pair<std::uint64_t, std::int32_t>> sorted(n);
  for (std::size_t i = 0; i < n; ++i) {
    sorted[ends[keys[i] >> (48 - kLeadingBits)]++] = {keys[i], static_cast<std::int32_t>(i)};
  }
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (end - begin > 1) {
      if (interrupt->Requested()) return {};
      std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
                sorted.begin() + static_cast<std::ptrdiff_t>(end));
    }
    begin = end;
  }
  std::vector<std::int32_t> order(n);
  std::transform(sorted.begin(), sorted.end(), order.begin(),
                 [](const auto& entry) { return entry.second; });
  return order;
}

}  // namespace ccst
