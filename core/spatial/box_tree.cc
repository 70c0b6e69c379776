#include "core/spatial/box_tree.h"

namespace ccst {

void BoxTree::Build(const std::vector<Eigen::Vector3d>& points) {
  points_ = &points;
  std::size_t level = 0;
  for (std::size_t below = points.size(); below > 0; ++level) {
    const std::size_t count = (below + kRun - 1) / kRun;
    if (levels_.size() == level) levels_.emplace_back();
    levels_[level].resize(count);
    for (std::size_t b = 0; b < count; ++b) {
      const std::size_t end = std::min((b + 1) * kRun, below);
      Box box;
      if (level == 0) {
        box = {points[b * kRun], points[b * kRun]};
        for (std::size_t i = b * kRun + 1; i < end; ++i) {
          box.low = box.low.cwiseMin(points[i]);
          box.high = box.high.cwiseMax(points[i]);
        }
      } else {
        box = levels_[level - 1][b * kRun];
        for (std::size_t i = b * kRun + 1; i < end; ++i) {
          box.low = box.low.cwiseMin(levels_[level - 1][i].low);
          box.high = box.high.cwiseMax(levels_[level - 1][i].high);
        }
      }
      levels_[level][b] = box;
    }
    below = count > kRun ? count : 0;
  }
  levels_.resize(level);
}

}  // namespace ccst
