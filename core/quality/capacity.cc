#include "core/quality/capacity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/mesh/faces.h"

namespace ccst::quality {
namespace {

double Area(std::span<const Eigen::Vector3d> positions, const Eigen::Vector3i& t) {
  return 0.5 * FaceCross(positions, t).norm();
}

}  // namespace

CapacityFigures MeasureCapacities(std::span<const Eigen::Vector3d> positions,
                                  std::span<const Eigen::Vector3i> triangles,
                                  std::span<const double> densities) {
  CapacityFigures figures;
  std::vector<double> capacities(triangles.size());
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    capacities[i] = Area(positions, triangles[i]) * (densities.empty() ? 1.0 : densities[i]);
    figures.total += capacities[i];
    smallest = std::min(smallest, capacities[i]);
    largest = std::max(largest, capacities[i]);
  }
  if (!(figures.total > 0.0)) return figures;
  figures.mean = figures.total / static_cast<double>(triangles.size());
  double squares = 0.0;  // About the mean: the sum of squares would lose the small cv.
  for (const double capacity : capacities) {
    const double deviation = capacity / figures.mean - 1.0;
    squares += deviation * deviation;
  }
  figures.cv = std::sqrt(squares / static_cast<double>(triangles.size()));
  figures.smallest = smallest / figures.mean;
  figures.largest = largest / figures.mean;
  return figures;
}

double TotalArea(std::span<const Eigen::Vector3d> positions,
                 std::span<const Eigen::Vector3i> triangles) {
  double area = 0.0;
  for (const Eigen::Vector3i& t : triangles) area += Area(positions, t);
  return area;
}

}  // namespace ccst::quality
