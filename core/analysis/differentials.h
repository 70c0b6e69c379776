#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/analysis/curve.h"
#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/parallel/parallel.h"
#include "core/surface/surface.h"

namespace ccst::analysis {

/// The distribution of the differences between samples, over as many sets as are added: what
/// differential domain analysis measures. Differences are in units of the spacing
/// 1 / sqrt(density), with the mean of the two ends' spacings where the density varies.
///
/// On a surface a difference is the place of one sample in the tangent plane of the other, see
/// GeodesicDisc; the area of the surface is counted through the same map, and what is reported is
/// the ratio of the two. So curvature, boundaries and thin parts cancel, and white noise has 1
/// everywhere.
/// Source: Wei, Wang, "Differential domain analysis for non-uniform sampling", SIGGRAPH 2011, with
/// a box as kernel; the axes of the tangent planes follow the normal, which turns them smoothly.
class Differentials {
 public:
  /// Distances counted: up to this many spacings, and less in small sets, see ReachFor().
  static constexpr double kReach = 8.0;
  /// Width of the bins in which pairs are counted, in spacings.
  static constexpr double kBinWidth = 0.005;
  /// Width of the bins of RadialMean(), in spacings.
  static constexpr double kMeanWidth = 0.025;
  /// Width of the rings of Anisotropy(), in spacings.
  static constexpr double kRingWidth = 0.1;

  /// kReach, or the radius that a quarter of `count` samples fills.
  static double ReachFor(std::int64_t count);

  /// For sets of `count` samples, > 0.
  explicit Differentials(std::int64_t count);

  /// Adds a set on a surface. Of more than 8000 samples, or where a disc has many faces, not all
  /// are centres, but every k-th: at most 8000, and no more than have 1e7 faces in their discs. All
  /// samples are seen from these. Cost at most about 1 s, 3 s where faces are the bound; the same
  /// bits on any number of threads.
  /// @param density    that the set follows, of `surface`.
  /// @param interrupt  may be null; once requested, what was added means nothing.
  void AddSurface(const Surface& surface, const Density& density,
                  std::span<const SurfacePoint> samples, const Parallel& parallel = Parallel(),
                  Interrupt* interrupt = nullptr);

  /// Adds a set in the plane whose rectangle [0, extents) is repeated on all sides.
  /// @param positions  n x 2. @param extents > 0; distances up to half the smaller one are counted.
  /// Cost O(n^2) at worst.
  void AddTorus(std::span<const Eigen::Vector2d> positions, const Eigen::Vector2d& extents);

  int sets() const { return sets_; }

  /// Density of samples at a distance over the mean one: the radial mean of the distribution, which
  /// is the pair correlation function. x in spacings, y >= 0; 1 for white noise. Bins of
  /// kMeanWidth.
  /// @param width  of the bins in spacings, a multiple of kBinWidth.
  Curve RadialMean(double width = kMeanWidth) const;

  /// How unevenly samples at a distance are spread over the directions, in dB. x in spacings, where
  /// there are samples at all. y = 10 log10(variance / mean / sets) of the numbers of samples in
  /// cells of equal area that hold one pair a set on average: Ulichney's variance over squared
  /// mean, times RadialMean() so that its noise does not depend on that. As in his plots, an
  /// isotropic distribution shows -10 log10(sets) at every distance and directions rise above it.
  Curve Anisotropy() const;

  /// Width of the noise of Anisotropy(): the standard deviation of y in dB for an isotropic
  /// distribution, at the places of `anisotropy`.
  std::vector<double> AnisotropyNoise(const Curve& anisotropy) const;

  /// Radial power spectrum: P(f) = 1 + density * integral of (g(r) - 1) J_0(2 pi f r) w(r) over the
  /// plane, g the pair correlation and w a window that ends at the reach. x is the frequency in
  /// units of sqrt(density); y is 1 for white noise, and may be a little negative by noise.
  /// @param last  largest frequency, > 0.  @param step  between frequencies, > 0.
  /// Source: Bartlett 1964 on the transform; Schloemer, Deussen, "Accurate spectral analysis of
  /// two-dimensional point sets", JGT 15(3), 2011, on taking it from the pair correlation, whose
  /// window (Blackman's) and normalisation these are.
  Curve PowerSpectrum(double last = 7.0, double step = 0.01) const;

 private:
  void CountDistance(double distance, double pairs);
  void CountDirection(const Eigen::Vector2d& difference);
  std::int64_t CellOf(const Eigen::Vector2d& difference) const;

  double reach_ = 0.0;
  int sets_ = 0;
  double centers_ = 0.0;
  std::vector<double> pairs_;      // Per bin: samples seen from the centres.
  std::vector<double> expected_;   // Per bin: the same for white noise, by the area seen.
  std::vector<double> cells_;      // Ring by ring: samples by direction.
  std::vector<std::size_t> ring_;  // First cell of each ring, and past the last.
};

}  // namespace ccst::analysis
