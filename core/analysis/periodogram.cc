#include "core/analysis/periodogram.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace ccst::analysis {

void Periodogram::Add(std::span<const Eigen::Vector2d> positions, const Eigen::Vector2d& extents) {
  const auto count = static_cast<double>(positions.size());
  const double root = std::sqrt(count / extents.prod());
  const auto columns = static_cast<int>(last_ * root * extents.x());
  const auto rows = static_cast<int>(last_ * root * extents.y());
  // P(-k) = P(k): half of the plane will do.
  const auto width = static_cast<std::size_t>(2 * columns + 1);
  std::vector<std::complex<double>> sums(width * static_cast<std::size_t>(rows + 1));
  std::vector<std::complex<double>> powers(width);
  for (const Eigen::Vector2d& p : positions) {
    const auto turn = [](double x) { return std::polar(1.0, -2.0 * std::numbers::pi * x); };
    for (int k = -columns; k <= columns; ++k) {
      powers[static_cast<std::size_t>(k + columns)] = turn(k * p.x() / extents.x());
    }
    for (int l = 0; l <= rows; ++l) {
      const std::complex<double> factor = turn(l * p.y() / extents.y());
      std::complex<double>* const row = sums.data() + static_cast<std::size_t>(l) * width;
      for (std::size_t k = 0; k < width; ++k) {
        // Written out: the library's product also looks for infinities.
        row[k] += std::complex<double>(
            factor.real() * powers[k].real() - factor.imag() * powers[k].imag(),
            factor.real() * powers[k].imag() + factor.imag() * powers[k].real());
      }
    }
  }
  const bool first = sets_++ == 0;
  unit_ = 1.0 / (root * extents.minCoeff());
  std::size_t next = 0;
  for (int l = 0; l <= rows; ++l) {
    for (int k = -columns; k <= columns; ++k) {
      if (l == 0 && k <= 0) continue;
      const double f = std::hypot(k / extents.x(), l / extents.y()) / root;
      if (f > last_) continue;
      const std::size_t at =
          static_cast<std::size_t>(l) * width + static_cast<std::size_t>(k + columns);
      const double power = std::norm(sums[at]) / count;
      if (first) {
        frequency_.push_back(f);
        power_.push_back(power);
      } else if (next < power_.size()) {
        power_[next] += power;
      }
      ++next;
    }
  }
}

std::vector<Periodogram::Ring> Periodogram::Rings() const {
  if (sets_ == 0) return {};
  struct Sums {
    double count = 0.0, frequency = 0.0, power = 0.0, squares = 0.0;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(last_ / unit_) + 2);
  for (std::size_t i = 0; i < power_.size(); ++i) {
    const double power = power_[i] / sets_;
    Sums& ring = sums[static_cast<std::size_t>(std::lround(frequency_[i] / unit_))];
    ring.count += 1.0;
    ring.frequency += frequency_[i];
    ring.power += power;
    ring.squares += power * power;
  }
  std::vector<Ring> rings;
  for (const Sums& s : sums) {
    if (s.count < 2.0) continue;
    const double mean = s.power / s.count;
    rings.push_back(
        {s.frequency / s.count, mean, (s.squares - s.count * mean * mean) / (s.count - 1.0)});
  }
  return rings;
}

Curve Periodogram::RadialMean() const {
  Curve curve;
  for (const Ring& ring : Rings()) {
    curve.x.push_back(ring.frequency);
    curve.y.push_back(ring.mean);
  }
  return curve;
}

Curve Periodogram::Anisotropy() const {
  Curve curve;
  for (const Ring& ring : Rings()) {
    if (!(ring.mean > 0.0) || !(ring.variance > 0.0)) continue;
    curve.x.push_back(ring.frequency);
    curve.y.push_back(10.0 * std::log10(ring.variance / (ring.mean * ring.mean)));
  }
  return curve;
}

}  // namespace ccst::analysis
