#pragma once

#include "core/analysis/curve.h"

namespace ccst::analysis {

/// Two figures of a radial power spectrum, for curves and for tables.
/// Source: Heck, Schloemer, Deussen, "Blue noise sampling with controlled aliasing", TOG 32(3),
/// 2013, section 4, with the thresholds of their program psa.
struct SpectralFigures {
  /// nu: the largest frequency up to which the spectrum holds nearly no power, that is below which
  /// its mean over the disc is at most 0.1, in units of sqrt(density) (psa: sqrt(n) / 2 is half of
  /// it); 0 for white noise.
  double effective_nyquist = 0.0;
  /// Omega: 10 times the root mean square over the plane of P - 1, from the first frequency where
  /// P reaches 0.98 (or its largest value) over the next five sqrt(density); near 0 for white
  /// noise.
  double oscillation = 0.0;
};

/// @param power  P(f) from near 0 to at least 6 sqrt(density), evenly spaced; x in units of
///               sqrt(density). All figures are 0 where it is empty.
SpectralFigures MeasureSpectrum(const Curve& power);

}  // namespace ccst::analysis
