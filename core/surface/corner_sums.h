#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"

namespace ccst {

/// Adds up at the vertices what faces give their corners, on several threads: at every vertex in
/// the order of the faces, so the same bits as on one. Faces are cut into pieces. Vertices whose
/// faces lie in one piece are that piece's own; what the others get is kept and added when all
/// pieces are done, in their order. Fast where faces that follow each other are near each other.
class CornerSums {
 public:
  /// @param faces  F x 3 indices in [0, vertex_count), must outlive this. Cost O(F).
  CornerSums(const std::vector<Eigen::Vector3i>& faces, std::int32_t vertex_count)
      : faces_(faces), shared_(vertex_count, 0) {
    std::vector<std::int32_t> piece(vertex_count, -1);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto own = static_cast<std::int32_t>(f / kPiece);
      for (const std::int32_t v : faces[f]) {
        if (piece[v] < 0) piece[v] = own;
        shared_[v] |= piece[v] != own;
      }
    }
  }

  /// Calls give(f, add) for every face f, which calls add(k, value) to add to the sum at corner k.
  /// @param sums  V, of a type with +=. @param interrupt  when requested, they are unfinished.
  template <typename Value, typename Give>
  void Add(const Parallel& parallel, Interrupt* interrupt, const Give& give,
           std::vector<Value>* sums) const {
    const auto count = static_cast<std::int64_t>(faces_.size());
    std::vector<std::vector<std::pair<std::int32_t, Value>>> kept((count + kPiece - 1) / kPiece);
    parallel.ForRanges(count, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
      if (Interrupt(stop).Requested()) return;
      auto& others = kept[static_cast<std::size_t>(first / kPiece)];
      for (std::int64_t f = first; f < end; ++f) {
        give(f, [&](int k, const Value& value) {
          const std::int32_t v = faces_[static_cast<std::size_t>(f)][k];
          if (shared_[v] != 0) {
            others.emplace_back(v, value);
          } else {
            (*sums)[v] += value;
          }
        });
      }
    });
    for (const auto& others : kept) {
      for (const auto& [v, value] : others) (*sums)[v] += value;
    }
  }

 private:
  static constexpr std::int64_t kPiece = 8192;

  const std::vector<Eigen::Vector3i>& faces_;
  std::vector<std::uint8_t> shared_;  // By faces of several pieces.
};

}  // namespace ccst
