#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/surface/surface.h"

/// The sampling methods that CCST is compared with, each as its paper says, carried over to
/// surfaces with a density. All return exactly `count` points, each with its host, and the same
/// points for the same arguments.
///
/// Lengths are those of the surface's unit frame. Where the density is rho, the spacing is
/// r_max / sqrt(rho) with r_max = sqrt(2 A / (sqrt(3) count)). Distances are straight, and two
/// points are neighbours only on one side of the surface: in the same component, with the normals
/// of their faces less than 120 degrees apart. So the sheets of a thin plate do not see each other
/// and the facets at a right-angled crease do.
///
/// `count` is in [4, 1000000] and the density is that of the surface; neither is checked.
namespace ccst {

/// One finished step of an iterative method.
struct MethodStep {
  int step = 0;                             ///< 1-based; 0 is the initial set.
  double energy = 0.0;                      ///< As the method says.
  double max_move = 0.0;                    ///< Longest move of a point in this step.
  const std::vector<SurfacePoint>& points;  ///< As they are now; valid during the call only.
};

/// How a caller watches and stops a method. Never changes the points of a whole run.
struct MethodControl {
  Interrupt* interrupt;  ///< Not null; polled at least every 50 ms of work.
  std::function<void(const MethodStep&)> on_step = {};  ///< May be empty. Must not throw.
};

/// Independent random points, each with probability rho / A an area.
/// @errors those of Interrupt::Error() when the interrupt was requested; the same for the methods
///         below unless said.
/// Cost O(F log F + n log F).
absl::StatusOr<std::vector<SurfacePoint>> DrawWhiteNoise(const Surface& surface,
                                                         const Density& density, std::int64_t count,
                                                         std::uint64_t seed,
                                                         const MethodControl& control);

/// What ThrowDarts() returns.
struct DartSamples {
  std::vector<SurfacePoint> points;  ///< In the order in which they were accepted.
  /// Two points on one side are at least radius / sqrt(rho) apart, with the larger rho of the two.
  double radius = 0.0;
};

/// Poisson disk samples by dart throwing: white noise is taken point by point, and a point is
/// accepted if none accepted before is within the radius. The radius is searched so that `count`
/// darts are accepted.
/// Approximate: the set is maximal among the darts thrown (20 a sample; fewer beyond 500,000
/// samples), not among all points of the surface; and the radius is the largest found for which at
/// least `count` darts are accepted, of which the last, at most 0.2 % where the search succeeds,
/// are dropped.
/// Cost O(n log n) for each of about six radii.
/// Source: Cook, "Stochastic sampling in computer graphics", TOG 5(1), 1986; on surfaces from a
/// pool of points as in Corsini, Cignoni, Scopigno, TVCG 18(6), 2012; the smaller of two disks
/// decides where they differ, as in Mitchell et al., "Variable radii Poisson-disk sampling", CCCG
/// 2012.
absl::StatusOr<DartSamples> ThrowDarts(const Surface& surface, const Density& density,
                                       std::int64_t count, std::uint64_t seed,
                                       const MethodControl& control);

/// Poisson disk samples by weighted sample elimination: of 5 n points of white noise the one with
/// the most and nearest neighbours is removed until n are left.
/// Source: Yuksel, "Sample elimination for generating Poisson disk sample sets", Eurographics 2015,
/// with his alpha = 8, beta = 0.65, gamma = 1.5 and weight limiting; where the density varies,
/// distances are over the smaller spacing of the two.
/// Cost O(n log n).
absl::StatusOr<std::vector<SurfacePoint>> EliminateSamples(const Surface& surface,
                                                           const Density& density,
                                                           std::int64_t count, std::uint64_t seed,
                                                           const MethodControl& control);

/// What the iterative methods return.
struct RelaxedSamples {
  std::vector<SurfacePoint> points;
  int steps = 0;
  double energy = 0.0;
  /// The method came to rest; else it ran into its limit of steps or the interrupt.
  bool converged = false;
};

struct LloydOptions {
  int max_steps = 100;
  /// At rest when no point moved by more than this part of its spacing; >= 0.
  double tolerance = 1e-3;
};

/// Lloyd's relaxation towards a centroidal Voronoi tessellation of the surface: each point moves to
/// the centroid of its region and back onto the surface. The regions, of the places that are
/// nearest to it of all points on their side, are integrated exactly, weighed by rho^2 (linear over
/// pieces of about a spacing), which makes the density of the points rho. Starts with one random
/// point in each of n regions of equal capacity, a component's share by largest remainder;
/// components without a share are left out. Energy: integral of rho^2 times the squared distance to
/// the point; it does not rise as long as regions stay on one side. Interrupted after the start, it
/// returns the points as they are, with energy 0 where that was not measured yet. Cost O(F + n) a
/// step; memory some 500 bytes a sample and 60 a face. Source: Lloyd 1982; Du, Faber, Gunzburger,
/// "Centroidal Voronoi tessellations", SIAM Review 41(4), 1999, on the density of the generators
/// and on surfaces.
absl::StatusOr<RelaxedSamples> RelaxLloyd(const Surface& surface, const Density& density,
                                          std::int64_t count, std::uint64_t seed,
                                          const LloydOptions& options,
                                          const MethodControl& control);

/// BalanceVoronoi() takes no more samples than this.
inline constexpr std::int64_t kMaxBalancedCount = 20000;

struct BalanceOptions {
  int max_steps = 1000;
  int points_per_sample = 256;  ///< [2, 1024]
};

/// Capacity-constrained Voronoi tessellation: each sample owns the same number of random points
/// of equal capacity; ownerships are swapped between pairs of samples while that lowers the
/// energy, the samples move to the centroids of what they own, and all ends when no swap is left.
/// Energy: sum of the squared distances of the points to their samples, each 4 r_max^2 more for a
/// point on another side; it never rises.
/// Starts with points that follow each other on a curve through the surface instead of an arbitrary
/// ownership, which saves most of the swaps.
/// Interrupted after the start, it returns the points as they are, with energy 0 where that was not
/// measured yet.
/// @errors INVALID_ARGUMENT LIMIT_EXCEEDED for a count over kMaxBalancedCount.
/// Cost O(n m log m) a step with m points a sample; some hundred steps.
/// Source: Balzer, Schloemer, Deussen, "Capacity-constrained point distributions: a variant of
/// Lloyd's method", SIGGRAPH 2009.
absl::StatusOr<RelaxedSamples> BalanceVoronoi(const Surface& surface, const Density& density,
                                              std::int64_t count, std::uint64_t seed,
                                              const BalanceOptions& options,
                                              const MethodControl& control);

}  // namespace ccst
