#include "core/methods/regions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/random/random.h"

namespace ccst {
namespace {

/// `count` shared out by `sizes`, largest remainders first.
std::vector<std::int64_t> ShareOut(std::int64_t count, const std::vector<double>& sizes) {
  double total = 0.0;
  for (const double size : sizes) total += size;
  std::vector<std::int64_t> shares(sizes.size());
  std::vector<std::pair<double, std::size_t>> remainders(sizes.size());
  std::int64_t left = count;
  for (std::size_t c = 0; c < sizes.size(); ++c) {
    const double exact = static_cast<double>(count) * (sizes[c] / total);
    shares[c] = std::min(left, static_cast<std::int64_t>(exact));
    left -= shares[c];
    remainders[c] = {static_cast<double>(shares[c]) - exact, c};
  }
  std::sort(remainders.begin(), remainders.end());
  for (std::size_t k = 0; left > 0; k = (k + 1) % remainders.size(), --left) {
    ++shares[remainders[k].second];
  }
  return shares;
}

}  // namespace

Regions CutRegions(const Density& density, const CapacityCurve& curve, std::int64_t count,
                   std::int64_t parts, std::uint64_t seed, std::uint64_t stream,
                   Interrupt* interrupt) {
  Regions regions;
  regions.parts = parts;
  regions.sites.reserve(count);
  regions.part_positions.reserve(count * parts);
  regions.part_faces.reserve(count * parts);
  regions.part_weights.reserve(count * parts);
  const double mean = curve.length() / static_cast<double>(count * parts);
  const CounterRandom in_part(seed, stream);
  const CounterRandom choice(seed, stream + 1);
  const std::vector<std::int64_t> shares = ShareOut(count, density.component_capacities());
  for (std::size_t c = 0; c < shares.size(); ++c) {
    const double begin = curve.ComponentBegin(static_cast<std::int32_t>(c));
    const double end = curve.ComponentBegin(static_cast<std::int32_t>(c) + 1);
    const double part = (end - begin) / static_cast<double>(shares[c] * parts);
    for (std::int64_t k = 0; k < shares[c]; ++k) {
      const std::int64_t chosen = static_cast<std::int64_t>(choice.Uniform(regions.sites.size()) *
                                                            static_cast<double>(parts));
      for (std::int64_t q = 0; q < parts; ++q) {
        const std::size_t i = regions.part_positions.size();
        if (interrupt->RequestedAt(static_cast<std::int64_t>(i))) return regions;
        const double along = (static_cast<double>(k * parts + q) + in_part.Uniform(i)) * part;
        const SurfacePoint point = curve.At(std::min(begin + along, end));
        if (q == chosen) regions.sites.push_back(point);
        regions.part_positions.push_back(point.position);
        regions.part_faces.push_back(point.face);
        regions.part_weights.push_back(
            static_cast<float>(part / mean * density.At(point.face, point.weights, part)));
      }
    }
  }
  return regions;
}

SurfacePoint MoveTo(const Surface& surface, const SurfacePoint& site,
                    const Eigen::Vector3d& centroid) {
  const SurfacePoint moved = surface.Follow(site.face, centroid);
  return (moved.position - centroid).squaredNorm() < (site.position - centroid).squaredNorm()
             ? moved
             : site;
}

}  // namespace ccst
