#include "core/analysis/spectral_figures.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ccst::analysis {
namespace {

constexpr double kLowPower = 0.1;    // Mean power that counts as nearly none.
constexpr double kHighPower = 0.5;   // Mean power above which the low region is over.
constexpr double kFirstPower = 0.98;  // Power from which oscillations are counted.
constexpr double kBand = 5.0;        // Over which they are counted, in sqrt(density).

double EffectiveNyquist(const Curve& power) {
  // Mean of P over the disc of radius f, by rings.
  std::vector<double> mean(power.x.size());
  double sum = 0.0;
  double previous = 0.0;
  for (std::size_t i = 0; i < power.x.size(); ++i) {
    const double f = power.x[i];
    sum += std::abs(power.y[i]) * (f * f - previous * previous);
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
  std::size_t first = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < power.x.size() && largest < kFirstPower; ++i) {
    if (power.y[i] <= largest) continue;
    largest = power.y[i];
    first = i;
  }
  double squares = 0.0;
  double area = 0.0;
  for (std::size_t i = first; i < power.x.size() && power.x[i] <= power.x[first] + kBand; ++i) {
    squares += (power.y[i] - 1.0) * (power.y[i] - 1.0) * power.x[i];
    area += power.x[i];
  }
  return area > 0.0 ? 10.0 * std::sqrt(squares / area) : 0.0;
}

}  // namespace

SpectralFigures MeasureSpectrum(const Curve& power) {
  return {EffectiveNyquist(power), Oscillation(power)};
}

}  // namespace ccst::analysis
