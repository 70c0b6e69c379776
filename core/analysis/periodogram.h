#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/analysis/curve.h"

namespace ccst::analysis {

/// The power spectrum of samples in the plane by direct transform, averaged over as many sets as
/// are added: P(k) = |sum_j exp(-2 pi i k . x_j)|^2 / n at the whole frequencies k of a rectangle
/// that is repeated on all sides.
/// Source: Ulichney, "Dithering with blue noise", Proc. IEEE 76(1), 1988.
class Periodogram {
 public:
  /// @param last  largest frequency in units of sqrt(density), > 0.
  explicit Periodogram(double last = 4.0) : last_(last) {}

  /// Adds a set in the rectangle [0, extents), extents > 0; all sets must have the same number of
  /// samples and the same extents. Cost O(n^2 last^2).
  void Add(std::span<const Eigen::Vector2d> positions, const Eigen::Vector2d& extents);

  /// Mean of P over rings of frequencies; x in units of sqrt(density), y >= 0 and 1 for white
  /// noise. The frequency 0 is left out.
  Curve RadialMean() const;

  /// Variance of P within each ring over the square of its mean, in dB: -10 log10(sets) where
  /// there are no preferred directions.
  Curve Anisotropy() const;

 private:
  struct Ring {
    double frequency;  // Mean of the ring's.
    double mean;
    double variance;
  };
  std::vector<Ring> Rings() const;

  double last_;
  double unit_ = 0.0;  // Frequencies to a ring, in sqrt(density).
  int sets_ = 0;
  std::vector<double> frequency_;  // Length of each frequency, in units of sqrt(density).
  std::vector<double> power_;      // Sum over the sets.
};

}  // namespace ccst::analysis
