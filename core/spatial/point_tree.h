#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "core/parallel/parallel.h"

namespace ccst {

/// The nearest of many points in space, by k-d trees: one for each run of points that follow each
/// other in memory, so that several threads can build them. Points in an order in which neighbours
/// in memory are neighbours in space (see HilbertOrder()) are found fastest; any order gives the
/// same answers. Immutable; queries may run on several threads.
class PointTree {
 public:
  /// Copies nothing: `points` (N x 3) must outlive the tree and stay as they are.
  /// Cost O(N log N).
  explicit PointTree(const std::vector<Eigen::Vector3d>& points,
                     const Parallel& parallel = Parallel());
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;

  /// The `count` points nearest to `query`, nearest first; equal distances by index, so the
  /// answer does not depend on how the trees were built. Fewer when there are fewer.
  /// Cost O(count log N + N / 50,000) expected.
  std::vector<std::int32_t> Nearest(const Eigen::Vector3d& query, int count) const;

 private:
  struct Run;
  std::vector<std::unique_ptr<Run>> runs_;
};

}  // namespace ccst
