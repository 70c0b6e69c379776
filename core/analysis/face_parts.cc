#include "core/analysis/face_parts.h"

#include <algorithm>
#include <cmath>

namespace ccst::analysis {
namespace {

// Bounds the parts of a face that carries most of the surface; a million parts will do for one.
constexpr double kMostRows = 1024.0;

}  // namespace

// Row i of a face has k - i upright triangles, with those upside down between them: 2 (k - i) - 1
// parts, that is k^2 - (k - i)^2 in the rows before it. The weights of a point are those of corner
// 0, by which rows count, and of corner 1, along the row.

FaceParts::FaceParts(const Surface& surface, const Density& density, double count) {
  double total = 0.0;
  for (const double capacity : density.face_capacities()) total += capacity;
  const std::size_t faces = density.face_capacities().size();
  first_.reserve(faces + 1);
  rows_.reserve(faces);
  for (std::size_t f = 0; f < faces; ++f) {
    first_.push_back(static_cast<std::int64_t>(capacity_.size()));
    const double capacity = density.face_capacities()[f];
    const double rows = std::ceil(std::sqrt(capacity / total * count));
    rows_.push_back(static_cast<std::int32_t>(std::clamp(rows, 1.0, kMostRows)));
    const std::int64_t parts = std::int64_t{rows_.back()} * rows_.back();
    if (parts == 1 || density.uniform()) {
      capacity_.insert(capacity_.end(), static_cast<std::size_t>(parts),
                       capacity / static_cast<double>(parts));
      continue;
    }
    const auto face = static_cast<std::int32_t>(f);
    const double area = surface.face_areas()[f] / static_cast<double>(parts);
    double sum = 0.0;
    for (std::int64_t k = first_.back(); k < first_.back() + parts; ++k) {
      capacity_.push_back(density.At(face, Centroid(face, k), area));
      sum += capacity_.back();
    }
    for (std::int64_t k = first_.back(); k < first_.back() + parts; ++k) {
      capacity_[static_cast<std::size_t>(k)] *= capacity / sum;
    }
  }
  first_.push_back(static_cast<std::int64_t>(capacity_.size()));
}

Eigen::Vector3d FaceParts::Centroid(std::int32_t face, std::int64_t part) const {
  const std::int64_t k = rows_[static_cast<std::size_t>(face)];
  const std::int64_t index = part - first(face);
  auto left = static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(k * k - index))));
  if (left * left - (k * k - index) >= 2 * left - 1) --left;  // Where the root was rounded up.
  const std::int64_t row = k - left;
  const std::int64_t along = index - (k * k - left * left);
  const double offset = along % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
  const double u = (static_cast<double>(row) + offset) / static_cast<double>(k);
  const std::int64_t across = along / 2;
  const double v = (static_cast<double>(across) + offset) / static_cast<double>(k);
  return {u, v, 1.0 - u - v};
}

std::int64_t FaceParts::Find(const SurfacePoint& point) const {
  const std::int64_t k = rows_[static_cast<std::size_t>(point.face)];
  const double u = point.weights[0] * static_cast<double>(k);
  const double v = point.weights[1] * static_cast<double>(k);
  const std::int64_t row = std::clamp(static_cast<std::int64_t>(u), std::int64_t{0}, k - 1);
  const std::int64_t left = k - row;
  const std::int64_t column = std::clamp(static_cast<std::int64_t>(v), std::int64_t{0}, left - 1);
  const bool upside_down =
      column < left - 1 && u - static_cast<double>(row) + v - static_cast<double>(column) > 1.0;
  return first(point.face) + k * k - left * left + 2 * column + (upside_down ? 1 : 0);
}

}  // namespace ccst::analysis
