#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

namespace ccst {

/// A k-d tree over points in space. Immutable; queries may run on several threads.
class PointTree {
 public:
  /// Copies nothing: `points` (N x 3) must outlive the tree and stay as they are.
  /// Cost O(N log N).
  explicit PointTree(const std::vector<Eigen::Vector3d>& points);
  ~PointTree();
  PointTree(PointTree&&) noexcept;
  PointTree& operator=(PointTree&&) noexcept;

  /// The `count` points nearest to `query`, nearest first; equal distances by index, so the
  /// answer does not depend on how the tree was built. Fewer when there are fewer.
  /// Cost O(count log N) expected.
  std::vector<std::int32_t> Nearest(const Eigen::Vector3d& query, int count) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace ccst
