#include "core/repair/weld.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/base/sort_in_runs.h"

namespace ccst::repair {
namespace {

/// Units of work, for an Interrupt, of looking for a leader near a vertex.
constexpr std::int64_t kWeldWork = 4;

std::uint64_t Hash(const Eigen::Vector3d& p) {
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) {
    // Adding zero turns -0 into +0, which is the same place.
    hash = (hash ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

struct CellHash {
  std::size_t operator()(const std::array<double, 3>& cell) const {
    return Hash({cell[0], cell[1], cell[2]});
  }
};

/// Sorting by hash, then by place, cannot be made slow by chosen coordinates.
void JoinEqual(const std::vector<Eigen::Vector3d>& positions, const std::vector<std::uint8_t>& used,
               Interrupt* interrupt, std::vector<std::int32_t>* leaders) {
  std::vector<std::pair<std::uint64_t, std::int32_t>> order;
  order.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (used[i]) order.emplace_back(Hash(positions[i]), static_cast<std::int32_t>(i));
  }
  SortInRuns(order.begin(), order.end(), interrupt);
  if (interrupt->Requested()) return;
  const auto before = [&](const auto& a, const auto& b) {
    const Eigen::Vector3d& p = positions[a.second];
    const Eigen::Vector3d& q = positions[b.second];
    return std::tie(p[0], p[1], p[2], a.second) < std::tie(q[0], q[1], q[2], b.second);
  };
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && order[end].first == order[i].first) ++end;
    if (interrupt->RequestedAfter(static_cast<std::int64_t>(end - i))) return;
    if (end - i > 1) SortInRuns(order.begin() + i, order.begin() + end, interrupt, before);
    std::int32_t leader = order[i].second;
    for (; i < end; ++i) {
      const std::int32_t vertex = order[i].second;
      if (positions[vertex] != positions[leader]) leader = vertex;
      (*leaders)[vertex] = leader;
    }
  }
}

/// Cells twice as wide as the tolerance: what is near lies in at most two of them per axis.
class LeaderGrid {
 public:
  LeaderGrid(const std::vector<Eigen::Vector3d>& positions, const Eigen::Vector3d& low,
             double extent, double tolerance)
      : positions_(positions),
        low_(low),
        tolerance_(tolerance),
        half_width_(std::max(tolerance, 1e-300 * extent)),  // Keeps cell numbers finite.
        next_(positions.size(), -1) {}

  /// Smallest-index leader near position `i`, -1 when there is none.
  std::int32_t FindNear(std::int32_t i) const {
    const Eigen::Vector3d p = positions_[i] - low_;
    const Eigen::Vector3d from = Cell(p - Eigen::Vector3d::Constant(tolerance_));
    const Eigen::Vector3d to = Cell(p + Eigen::Vector3d::Constant(tolerance_));
    std::int32_t best = -1;
    for (int corner = 0; corner < 8; ++corner) {
      std::array<double, 3> cell;
      bool repeated = false;
      for (int k = 0; k < 3; ++k) {
        const bool upper = (corner >> k & 1) != 0;
        repeated |= upper && from[k] == to[k];
        cell[k] = upper ? to[k] : from[k];
      }
      if (repeated) continue;
      const auto found = first_.find(cell);
      if (found == first_.end()) continue;
      for (std::int32_t j = found->second; j >= 0; j = next_[j]) {
        const bool near = (positions_[j] - positions_[i]).stableNorm() <= tolerance_;
        if (near && (best < 0 || j < best)) best = j;
      }
    }
    return best;
  }

  void Add(std::int32_t i) {
    const Eigen::Vector3d cell = Cell(positions_[i] - low_);
    const auto [entry, fresh] = first_.try_emplace({cell[0], cell[1], cell[2]}, i);
    if (fresh) return;
    next_[i] = entry->second;
    entry->second = i;
  }

 private:
  Eigen::Vector3d Cell(const Eigen::Vector3d& p) const {
    // Halving first keeps large tolerances from overflowing; adding zero removes -0.
    return (0.5 * p / half_width_).array().floor() + 0.0;
  }

  const std::vector<Eigen::Vector3d>& positions_;
  Eigen::Vector3d low_;
  double tolerance_;
  double half_width_;
  std::unordered_map<std::array<double, 3>, std::int32_t, CellHash> first_;
  std::vector<std::int32_t> next_;
};

}  // namespace

bool AllDiffer(const std::vector<Eigen::Vector3d>& positions, const Parallel& parallel,
               Interrupt* interrupt) {
  // Sorted piece by piece, in pieces that fit the cache.
  constexpr int kPieceBits = 10;
  constexpr std::int64_t kPieces = 64;
  const int shift =
      64 - std::clamp(static_cast<int>(std::bit_width(positions.size())) - kPieceBits, 1, 20);
  std::vector<std::uint32_t> start((std::size_t{1} << (64 - shift)) + 1, 0);
  std::vector<std::uint64_t> hashes(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    hashes[i] = Hash(positions[i]);
    ++start[(hashes[i] >> shift) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint64_t> sorted(hashes.size());
  std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
  for (const std::uint64_t hash : hashes) sorted[fill[hash >> shift]++] = hash;
  std::atomic<bool> differ = true;
  const auto count = static_cast<std::int64_t>(start.size()) - 1;
  parallel.ForRanges(count, kPieces, [&, stop = *interrupt](std::int64_t first, std::int64_t last) {
    if (!differ || Interrupt(stop).Requested()) return;
    for (auto piece = static_cast<std::size_t>(first); piece < static_cast<std::size_t>(last);
         ++piece) {
      const auto begin = sorted.begin() + start[piece];
      const auto end = sorted.begin() + start[piece + 1];
      std::sort(begin, end);
      if (std::adjacent_find(begin, end) != end) differ = false;
    }
  });
  return differ && !interrupt->Requested();
}

std::vector<std::int32_t> WeldLeaders(const std::vector<Eigen::Vector3d>& positions,
                                      const std::vector<std::uint8_t>& used, double tolerance,
                                      Interrupt* interrupt) {
  std::vector<std::int32_t> leaders(positions.size());
  std::iota(leaders.begin(), leaders.end(), 0);
  JoinEqual(positions, used, interrupt, &leaders);
  if (!(tolerance > 0.0) || interrupt->Requested()) return leaders;

  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!used[i]) continue;
    low = low.cwiseMin(positions[i]);
    high = high.cwiseMax(positions[i]);
  }
  LeaderGrid grid(positions, low, (high - low).maxCoeff(), tolerance);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto vertex = static_cast<std::int32_t>(i);
    if (interrupt->RequestedAfter(kWeldWork)) return leaders;
    if (!used[i]) continue;
    if (leaders[i] != vertex) {
      leaders[i] = leaders[leaders[i]];  // An equal one came before and has settled.
      continue;
    }
    const std::int32_t near = grid.FindNear(vertex);
    if (near >= 0) {
      leaders[i] = near;
    } else {
      grid.Add(vertex);
    }
  }
  return leaders;
}

}  // namespace ccst::repair
