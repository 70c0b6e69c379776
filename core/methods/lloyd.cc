#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/methods/capacity_curve.h"
#include "core/methods/methods.h"
#include "core/methods/pieces.h"
#include "core/methods/sides.h"
#include "core/methods/strata.h"
#include "core/spatial/box_tree.h"

namespace ccst {
namespace {

constexpr std::uint64_t kStream = 0x6c6c6f7964;  // "lloyd"

/// Neighbours of sites that are kept, on average; with a uniform density there are about 12.
constexpr std::size_t kMostNeighbors = 24;

/// Units of work, for an Interrupt, of moving a site, which may cross many thin faces.
constexpr std::int64_t kMoveWork = 32;
/// Sites looked at that are one unit of work of an Interrupt.
constexpr std::int64_t kSitesAUnit = 64;

/// A site near a piece or near another site.
struct Near {
  double distance;
  std::int32_t site;
  bool operator<(const Near& other) const {
    return distance != other.distance ? distance < other.distance : site < other.site;
  }
};

/// Centre of a piece and the distance of its farthest corner from there.
struct Ball {
  explicit Ball(const Piece& piece)
      : center((piece.corners[0] + piece.corners[1] + piece.corners[2]).head<3>().cast<double>() /
               3.0) {
    for (const Eigen::Vector4f& corner : piece.corners) {
      radius = std::max(radius, (corner.head<3>().cast<double>() - center).norm());
    }
  }

  Eigen::Vector3d center;
  double radius = 0.0;
};

/// Lloyd's relaxation as a state that is stepped. Every piece has an owner, the site nearest to its
/// centre when last looked; that makes the sites near it in the next step a short list.
class Lloyd {
 public:
  Lloyd(const Surface& surface, std::vector<Piece> pieces, std::vector<SurfacePoint> sites)
      : surface_(surface),
        sides_(surface),
        pieces_(std::move(pieces)),
        sites_(std::move(sites)),
        positions_(sites_.size()) {
    for (std::size_t s = 0; s < sites_.size(); ++s) positions_[s] = sites_[s].position;
  }

  const std::vector<SurfacePoint>& sites() const { return sites_; }

  /// Gives every piece the site nearest to its centre: on its side if there is one no more than
  /// twice as far as the nearest of its component. Pieces of components without sites are dropped.
  void FindOwners(double r_max, Interrupt* interrupt) {
    std::vector<char> has_site(surface_.component_areas().size(), 0);
    const std::vector<std::int32_t>& components = surface_.face_components();
    for (const SurfacePoint& site : sites_) has_site[components[site.face]] = 1;
    std::erase_if(pieces_, [&](const Piece& piece) { return !has_site[components[piece.face]]; });
    tree_.Build(positions_);
    owners_.assign(pieces_.size(), -1);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      if (interrupt->RequestedAt(static_cast<std::int64_t>(p))) return;
      const std::int32_t face = pieces_[p].face;
      const Ball ball(pieces_[p]);
      constexpr double kFar = std::numeric_limits<double>::infinity();
      Near any = {kFar, -1};
      Near same = {kFar, -1};
      for (double radius = r_max; same.site < 0; radius *= 2.0) {
        const bool last = any.site >= 0;
        std::int64_t seen = 0;
        tree_.ForEachWithin(ball.center, radius, [&](std::int32_t s, double squared) {
          ++seen;
          if (components[sites_[s].face] != components[face]) return;
          any = std::min(any, Near{squared, s});
          if (sides_.Same(face, sites_[s].face)) same = std::min(same, Near{squared, s});
        });
        if (interrupt->RequestedAfter(seen / kSitesAUnit)) return;
        if (last) break;
      }
      owners_[p] = same.site >= 0 ? same.site : any.site;
    }
  }

  /// Finds the regions and returns the energy. False results when `interrupt` was requested; the
  /// sites are as they were then.
  double Assign(Interrupt* interrupt) {
    FindNeighbors(interrupt);
    double energy = 0.0;
    sums_.assign(sites_.size(), Eigen::Vector4d::Zero());
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      if (interrupt->RequestedAt(static_cast<std::int64_t>(p))) return energy;
      FindNearest(p);
      if (interrupt->RequestedAfter(examined_ / kSitesAUnit)) return energy;
      // Each of the sites near a piece is held against every other.
      const std::int64_t work = 1 + static_cast<std::int64_t>(near_.size()) / kSitesAUnit;
      for (std::size_t k = 0; k < near_.size(); ++k) {
        if (interrupt->RequestedAfter(work)) return energy;
        const PieceClipper::Moments moments = clipper_.Integrate(pieces_[p], near_positions_, k);
        sums_[near_[k].site] += moments.first;
        energy += moments.second;
      }
    }
    return energy;
  }

  /// Moves every site to the centroid of its region and calls moved(site, distance). Once
  /// `interrupt` is requested the others stay.
  template <class Moved>
  void Move(Interrupt* interrupt, Moved&& moved) {
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      if (interrupt->RequestedAfter(kMoveWork)) return;
      if (!(sums_[s][3] > 0.0)) continue;
      sites_[s] = MoveTo(surface_, sites_[s], sums_[s].head<3>() / sums_[s][3]);
      moved(sites_[s], (sites_[s].position - positions_[s]).norm());
      positions_[s] = sites_[s].position;
    }
  }

 private:
  /// Reads the sites that may be nearest somewhere in the pieces that `site` owns into the end of
  /// `list`: with R the distance of the farthest point of those, they are at most 2 R away. By
  /// distance.
  void AppendNeighbors(std::int32_t site, std::vector<Near>& list) const {
    const auto begin = static_cast<std::ptrdiff_t>(list.size());
    tree_.ForEachWithin(positions_[site], 2.0 * reach_[site],
                        [&](std::int32_t other, double squared) {
                          if (other != site) list.push_back({std::sqrt(squared), other});
                        });
    std::sort(list.begin() + begin, list.end());
  }

  /// The neighbours of a site, found anew where their list was too long to be kept.
  std::span<const Near> NeighborsOf(std::int32_t site) {
    const std::ptrdiff_t begin = neighbor_ends_[site];
    const std::ptrdiff_t end = neighbor_ends_[site + 1];
    if (is_kept_[site] != 0) {
      return std::span<const Near>(neighbors_)
          .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
    }
    if (long_site_ != site) {
      long_site_ = site;
      long_list_.clear();
      AppendNeighbors(site, long_list_);
      examined_ += static_cast<std::int64_t>(long_list_.size());
    }
    return long_list_;
  }

  /// Lists the neighbours of all sites. Where the density varies much one site may have thousands,
  /// and all lists together would take memory without bound: those that do not fit are not kept.
  void FindNeighbors(Interrupt* interrupt) {
    tree_.Build(positions_);
    reach_.assign(sites_.size(), 0.0);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      const Ball ball(pieces_[p]);
      double& reach = reach_[owners_[p]];
      reach = std::max(reach, (ball.center - positions_[owners_[p]]).norm() + ball.radius);
    }
    const std::size_t most = kMostNeighbors * sites_.size();
    neighbors_.clear();
    neighbors_.reserve(most);
    neighbor_ends_.assign(1, 0);
    is_kept_.assign(sites_.size(), 1);
    long_site_ = -1;
    std::vector<Near> list;
    for (std::size_t s = 0; s < sites_.size(); ++s) {
      list.clear();
      AppendNeighbors(static_cast<std::int32_t>(s), list);
      const auto found = static_cast<std::int64_t>(list.size());
      if (interrupt->RequestedAfter(1 + found / kSitesAUnit)) return;
      is_kept_[s] = static_cast<char>(neighbors_.size() + list.size() <= most);
      if (is_kept_[s] != 0) neighbors_.insert(neighbors_.end(), list.begin(), list.end());
      neighbor_ends_.push_back(static_cast<std::ptrdiff_t>(neighbors_.size()));
    }
  }

  /// Lists the sites that may be nearest somewhere in a piece, those on its side; the owner alone
  /// when there are none. The nearest to the centre becomes the owner.
  void FindNearest(std::size_t p) {
    const std::int32_t face = pieces_[p].face;
    const std::int32_t owner = owners_[p];
    const Ball ball(pieces_[p]);
    const double to_owner = (ball.center - positions_[owner]).norm();
    near_.clear();
    examined_ = 0;
    Near nearest = {std::numeric_limits<double>::infinity(), owner};
    if (sides_.Same(face, sites_[owner].face)) {
      nearest = {to_owner, owner};
      near_.push_back(nearest);
    }
    for (const auto& [apart, site] : NeighborsOf(owner)) {
      ++examined_;
      if (apart > to_owner + nearest.distance + 2.0 * ball.radius) break;
      if (!sides_.Same(face, sites_[site].face)) continue;
      const double distance = (ball.center - positions_[site]).norm();
      if (distance > nearest.distance + 2.0 * ball.radius) continue;
      near_.push_back({distance, site});
      nearest = std::min(nearest, near_.back());
    }
    std::erase_if(near_,
                  [&](const Near& n) { return n.distance > nearest.distance + 2.0 * ball.radius; });
    if (near_.empty()) near_.push_back({to_owner, owner});
    owners_[p] = nearest.site;
    near_positions_.clear();
    for (const Near& n : near_) near_positions_.push_back(positions_[n.site]);
  }

  const Surface& surface_;
  Sides sides_;
  std::vector<Piece> pieces_;
  std::vector<std::int32_t> owners_;  // Per piece.
  std::vector<SurfacePoint> sites_;
  std::vector<Eigen::Vector3d> positions_;  // Of the sites.
  std::vector<Eigen::Vector4d> sums_;       // Per site: first moments of its region.
  std::vector<double> reach_;               // Per site: distance of the farthest point it owns.
  std::vector<Near> neighbors_;
  std::vector<std::ptrdiff_t> neighbor_ends_;  // Those of site s end at entry s + 1.
  std::vector<char> is_kept_;                  // Per site: its neighbours are in the list.
  std::int32_t long_site_ = -1;                // Whose neighbours are in long_list_.
  std::vector<Near> long_list_;
  std::int64_t examined_ = 0;  // Neighbours looked at for the last piece.
  std::vector<Near> near_;
  std::vector<Eigen::Vector3d> near_positions_;
  PieceClipper clipper_;
  BoxTree tree_;
};

}  // namespace

absl::StatusOr<RelaxedSamples> RelaxLloyd(const Surface& surface, const Density& density,
                                          std::int64_t count, std::uint64_t seed,
                                          const LloydOptions& options,
                                          const MethodControl& control) {
  const CapacityCurve curve(surface, density, control.interrupt);
  const double r_max = HexagonalSpacing(surface, count);
  const double footprint = surface.area() / static_cast<double>(count);
  std::vector<SurfacePoint> start;
  start.reserve(count);
  ForEachStratum(density, curve, count, 1, CounterRandom(seed, kStream), control.interrupt,
                 [&](const SurfacePoint& point) { start.push_back(point); });
  Interrupt* const interrupt = control.interrupt;
  if (interrupt->Requested()) return interrupt->Error("the first samples were drawn");
  Lloyd lloyd(surface, CutPieces(surface, density, r_max, interrupt), std::move(start));
  if (!interrupt->Requested()) lloyd.FindOwners(r_max, interrupt);
  RelaxedSamples result;
  double max_move = 0.0;
  while (!interrupt->Requested()) {
    const double energy = lloyd.Assign(interrupt);
    if (interrupt->Requested()) break;
    result.energy = energy;
    if (control.on_step) control.on_step({result.steps, energy, max_move, lloyd.sites()});
    if (result.converged || result.steps >= options.max_steps) break;
    max_move = 0.0;
    double largest = 0.0;  // In spacings.
    lloyd.Move(interrupt, [&](const SurfacePoint& site, double distance) {
      max_move = std::max(max_move, distance);
      const double rho = density.At(site.face, site.weights, footprint);
      largest = std::max(largest, distance * std::sqrt(rho) / r_max);
    });
    if (interrupt->Requested()) break;
    ++result.steps;
    result.converged = largest <= options.tolerance;
  }
  result.points = lloyd.sites();
  return result;
}

}  // namespace ccst
