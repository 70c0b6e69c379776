#include "core/analysis/spectral_figures.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ccst::analysis {
namespace {

constexpr double kLowPower = 0.1;     // Mean power that counts as nearly none.
constexpr double kHighPower = 0.5;    // Mean power above which the low region is over.
constexpr double kFirstPower = 0.98;  // Power from which oscillations are counted.
constexpr double kBand = 5.0;         // Over which they are counted, in sqrt(density).

// psa's window is 1.01 at its middle, so its spectra are by this much farther from 1 than those of
// a direct transform; printed figures are of such spectra.
constexpr double kExcess = 1.01;

std::vector<double> AsPrinted(const Curve& power) {
  std::vector<double> y;
  for (const double p : power.y) y.push_back(std::abs(1.0 + kExcess * (p - 1.0)));
  return y;
}

double EffectiveNyquist(const Curve& power) {
  // Mean of P over the disc of radius f, by rings.
  std::vector<double> mean(power.x.size());
  double sum = 0.0;
  double previous = 0.0;
  const std::vector<double> y = AsPrinted(power);
  for (std::size_t i = 0; i < power.x.size(); ++i) {
    const double f = power.x[i];
    sum += y[i] * (f * f - previous * previous);
    mean[i] = sum / (f * f);
    previous = f;
  }
  // Noise may lift the mean over the threshold near 0: search from where the power is high.
  std::size_t high = 0;
  while (high < mean.size() && !(power.x[high] >= 0.5 && mean[high] > kHighPower)) ++high;
  if (high == mean.size()) return 0.0;
  for (std::size_t i = high; i > 0; --i) {
    if (mean[i] <= kLowPower) return power.x[i];
  }
  return 0.0;
}

double Oscillation(const Curve& power) {
  const std::vector<double> y = AsPrinted(power);
  std::size_t first = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < y.size() && largest < kFirstPower; ++i) {
    if (y[i] <= largest) continue;
    largest = y[i];
    first = i;
  }
  double squares = 0.0;
  double area = 0.0;
  for (std::size_t i = first; i < power.x.size() && power.x[i] <= power.x[first] + kBand; ++i) {
    squares += (y[i] - 1.0) * (y[i] - 1.0) * power.x[i];
    area += power.x[i];
  }
  return area > 0.0 ? 10.0 * std::sqrt(squares / area) : 0.0;
}

}  // namespace

SpectralFigures MeasureSpectrum(const Curve& power) {
  return {EffectiveNyquist(power), Oscillation(power)};
}

}  // namespace ccst::analysis
