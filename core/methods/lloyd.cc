#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/methods/capacity_curve.h"
#include "core/methods/methods.h"
#include "core/methods/regions.h"
#include "core/methods/sides.h"
#include "core/spatial/box_tree.h"

namespace ccst {
namespace {

constexpr std::uint64_t kStream = 0x6c6c6f7964;  // "lloyd"

/// Parts a sample, and about how many in all.
constexpr std::int64_t kMaxParts = 400;
constexpr std::int64_t kMinParts = 16;
constexpr std::int64_t kAllParts = 4'000'000;

/// A site that may be nearer to a part than the part's own.
struct Candidate {
  double distance;  // From the own site.
  std::int32_t site;
  bool operator<(const Candidate& other) const {
    return distance != other.distance ? distance < other.distance : site < other.site;
  }
};

/// Lloyd's relaxation as a state that is stepped.
class Lloyd {
 public:
  Lloyd(const Surface& surface, Regions regions)
      : surface_(surface),
        sides_(surface),
        regions_(std::move(regions)),
        owner_(regions_.part_positions.size()),
        site_positions_(regions_.sites.size()) {
    for (std::size_t p = 0; p < owner_.size(); ++p) {
      owner_[p] = static_cast<std::int32_t>(p / regions_.parts);
    }
    for (std::size_t s = 0; s < site_positions_.size(); ++s) {
      site_positions_[s] = regions_.sites[s].position;
    }
  }

  const std::vector<SurfacePoint>& sites() const { return regions_.sites; }

  /// Gives every part to its nearest site and returns the energy. False results when `interrupt`
  /// was requested; the sites are as they were then.
  double Assign(Interrupt* interrupt) {
    FindCandidates(interrupt);
    double energy = 0.0;
    sums_.assign(sites().size(), Eigen::Vector4d::Zero());
    for (std::size_t p = 0; p < owner_.size(); ++p) {
      if (interrupt->RequestedAt(static_cast<std::int64_t>(p))) return energy;
      const double distance = FindNearest(p);
      const Eigen::Vector3d& position = regions_.part_positions[p];
      const double weight = regions_.part_weights[p];
      sums_[owner_[p]] += weight * Eigen::Vector4d(position[0], position[1], position[2], 1.0);
      energy += weight * distance * distance;
    }
    return energy;
  }

  /// Moves every site to the centroid of its parts and calls moved(site, distance).
  template <class Moved>
  void Move(Moved&& moved) {
    for (std::size_t s = 0; s < sites().size(); ++s) {
      if (!(sums_[s][3] > 0.0)) continue;
      SurfacePoint& site = regions_.sites[s];
      site = MoveTo(surface_, site, sums_[s].head<3>() / sums_[s][3]);
      moved(site, (site.position - site_positions_[s]).norm());
      site_positions_[s] = site.position;
    }
  }

 private:
  /// A site nearer to a part than its own, at most R away, is less than 2 R from the own site: all
  /// such sites, by that distance, with R that of the own site's farthest part.
  void FindCandidates(Interrupt* interrupt) {
    tree_.Build(site_positions_);
    reach_.assign(sites().size(), 0.0);
    for (std::size_t p = 0; p < owner_.size(); ++p) {
      double& reach = reach_[owner_[p]];
      reach =
          std::max(reach, (regions_.part_positions[p] - site_positions_[owner_[p]]).squaredNorm());
    }
    candidates_.clear();
    candidate_ends_.assign(1, 0);
    for (std::size_t s = 0; s < sites().size(); ++s) {
      if (interrupt->RequestedAt(static_cast<std::int64_t>(s))) return;
      const auto self = static_cast<std::int32_t>(s);
      tree_.ForEachWithin(site_positions_[s], 2.0 * std::sqrt(reach_[s]),
                          [&](std::int32_t other, double squared) {
                            if (other != self) candidates_.push_back({std::sqrt(squared), other});
                          });
      std::sort(candidates_.begin() + candidate_ends_.back(), candidates_.end());
      candidate_ends_.push_back(static_cast<std::ptrdiff_t>(candidates_.size()));
    }
  }

  /// Gives one part to the nearest site on its side and returns the distance; leaves it where it is
  /// when none of the candidates is on its side.
  double FindNearest(std::size_t p) {
    const std::int32_t own = owner_[p];
    const std::int32_t face = regions_.part_faces[p];
    const Eigen::Vector3d& position = regions_.part_positions[p];
    const double to_own = (position - site_positions_[own]).norm();
    double least =
        sides_.Same(face, sites()[own].face) ? to_own : std::numeric_limits<double>::infinity();
    for (std::ptrdiff_t k = candidate_ends_[own]; k < candidate_ends_[own + 1]; ++k) {
      const Candidate& candidate = candidates_[k];
      if (candidate.distance >= to_own + least) break;
      const double squared = (position - site_positions_[candidate.site]).squaredNorm();
      if (squared < least * least && sides_.Same(face, sites()[candidate.site].face)) {
        least = std::sqrt(squared);
        owner_[p] = candidate.site;
      }
    }
    return std::isfinite(least) ? least : to_own;
  }

  const Surface& surface_;
  Sides sides_;
  Regions regions_;
  std::vector<std::int32_t> owner_;  // Per part.
  std::vector<Eigen::Vector3d> site_positions_;
  std::vector<Eigen::Vector4d> sums_;  // Per site: weighted positions of its parts, weights.
  std::vector<double> reach_;          // Per site: squared distance of its farthest part.
  std::vector<Candidate> candidates_;
  std::vector<std::ptrdiff_t> candidate_ends_;  // Those of site s end at entry s + 1.
  BoxTree tree_;
};

}  // namespace

absl::StatusOr<RelaxedSamples> RelaxLloyd(const Surface& surface, const Density& density,
                                          std::int64_t count, std::uint64_t seed,
                                          const LloydOptions& options,
                                          const MethodControl& control) {
  const CapacityCurve curve(surface, density);
  const std::int64_t parts = std::clamp(kAllParts / count, kMinParts, kMaxParts);
  Regions regions = CutRegions(density, curve, count, parts, seed, kStream, control.interrupt);
  if (control.interrupt->Requested()) {
    return absl::CancelledError("stopped while the first regions were cut");
  }
  const double r_max = HexagonalSpacing(surface, count);
  const double footprint = surface.area() / static_cast<double>(count);
  const double part_capacity = curve.length() / static_cast<double>(count * parts);
  Lloyd lloyd(surface, std::move(regions));
  RelaxedSamples result;
  double max_move = 0.0;
  while (true) {
    const double energy = part_capacity * lloyd.Assign(control.interrupt);
    if (control.interrupt->Requested()) break;
    result.energy = energy;
    if (control.on_step) control.on_step({result.steps, energy, max_move, lloyd.sites()});
    if (result.converged || result.steps >= options.max_steps) break;
    max_move = 0.0;
    double largest = 0.0;  // In spacings.
    lloyd.Move([&](const SurfacePoint& site, double distance) {
      max_move = std::max(max_move, distance);
      const double rho = density.At(site.face, site.weights, footprint);
      largest = std::max(largest, distance * std::sqrt(rho) / r_max);
    });
    ++result.steps;
    result.converged = largest <= options.tolerance;
  }
  result.points = lloyd.sites();
  return result;
}

}  // namespace ccst
