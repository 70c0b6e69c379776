#include "core/analysis/differentials.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/analysis/face_parts.h"
#include "core/analysis/geodesic_disc.h"

namespace ccst::analysis {
namespace {

constexpr double kPi = std::numbers::pi;

// No more centres than this; more of them would only make the noise of one set smaller than that
// between sets.
constexpr std::int64_t kMostCenters = 8000;
// No more faces laid flat than about this; bounds the time on dense meshes.
constexpr double kMostFaces = 1e7;
// Points at which the area is counted, per sample.
constexpr double kAreaPoints = 4.0;
// Centres from which one thread looks in one go.
constexpr std::int64_t kPiece = 128;
// Pairs of a piece kept one by one.
constexpr std::size_t kMostPairs = std::size_t{1} << 20;
// Samples and points looked at that are one unit of work of an Interrupt.
constexpr std::int64_t kItemsAUnit = 64;
// Directions are told apart in cells; no ring has more.
constexpr std::size_t kMostCells = 1u << 16;

// What lies on the faces, by face: samples, then points that stand for the area.
struct Content {
  struct Item {
    Eigen::Vector3d weights;
    double spacing;      // 1 / sqrt(density) there [unit].
    double samples;      // That white noise would have there; 0 for a sample.
    std::int32_t index;  // Of a sample, else -1.
  };
  std::vector<Item> items;
  std::vector<std::size_t> start;  // F + 1.
};

Content Place(const Surface& surface, const Density& density,
              std::span<const SurfacePoint> samples) {
  const auto count = static_cast<double>(samples.size());
  const double per_area = count / surface.area();
  const FaceParts parts(surface, density, kAreaPoints * count);
  const auto spacing = [&](std::int32_t face, const Eigen::Vector3d& weights) {
    return 1.0 / std::sqrt(per_area * density.At(face, weights, 1.0 / per_area));
  };
  const std::int32_t faces = surface.face_count();
  std::vector<std::vector<std::int32_t>> on_face(static_cast<std::size_t>(faces));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    on_face[static_cast<std::size_t>(samples[i].face)].push_back(static_cast<std::int32_t>(i));
  }
  Content content;
  content.start.reserve(on_face.size() + 1);
  content.items.reserve(samples.size() + static_cast<std::size_t>(parts.size()));
  for (std::int32_t face = 0; face < faces; ++face) {
    content.start.push_back(content.items.size());
    for (const std::int32_t i : on_face[static_cast<std::size_t>(face)]) {
      const Eigen::Vector3d& weights = samples[static_cast<std::size_t>(i)].weights;
      content.items.push_back({weights, spacing(face, weights), 0.0, i});
    }
    for (std::int64_t k = parts.first(face); k < parts.first(face + 1); ++k) {
      const Eigen::Vector3d weights = parts.Centroid(face, k);
      content.items.push_back({weights, spacing(face, weights), per_area * parts.Capacity(k), -1});
    }
  }
  content.start.push_back(content.items.size());
  return content;
}

// Blackman's window: 1 at 0, 0 at 1.
double Window(double x) {
  if (x >= 1.0) return 0.0;
  return 0.42 + 0.5 * std::cos(kPi * x) + 0.08 * std::cos(2.0 * kPi * x);
}

}  // namespace

double Differentials::ReachFor(std::int64_t count) {
  const double reach = std::min(kReach, std::sqrt(static_cast<double>(count) / (4.0 * kPi)));
  return std::max(1.0, std::floor(reach / kRingWidth) * kRingWidth);
}

Differentials::Differentials(std::int64_t count) : reach_(ReachFor(count)) {
  const auto bins = static_cast<std::size_t>(std::lround(reach_ / kBinWidth));
  pairs_.assign(bins, 0.0);
  expected_.assign(bins, 0.0);
  const auto rings = static_cast<std::size_t>(std::lround(reach_ / kRingWidth));
  const auto centers = static_cast<double>(std::min(count, kMostCenters));
  ring_.push_back(0);
  for (std::size_t j = 0; j < rings; ++j) {
    // Half a ring, as a pair shows in two opposite directions.
    const double area = kPi * (static_cast<double>(j) + 0.5) * kRingWidth * kRingWidth;
    const auto cells = static_cast<std::size_t>(std::lround(area * centers));
    ring_.push_back(ring_.back() + std::clamp<std::size_t>(cells, 2, kMostCells));
  }
  cells_.assign(ring_.back(), 0.0);
}

void Differentials::CountDistance(double distance, double pairs) {
  const auto bin = static_cast<std::size_t>(distance / kBinWidth);
  if (bin < pairs_.size()) pairs_[bin] += pairs;
}

// The cell of cells_ in which a difference lies, -1 beyond the last ring.
std::int64_t Differentials::CellOf(const Eigen::Vector2d& difference) const {
  const auto ring = static_cast<std::size_t>(difference.norm() / kRingWidth);
  if (ring + 1 >= ring_.size()) return -1;
  double turn = std::atan2(difference.y(), difference.x()) / kPi;  // In [-1, 1].
  turn -= std::floor(turn);
  const std::size_t cells = ring_[ring + 1] - ring_[ring];
  const auto cell = static_cast<std::size_t>(turn * static_cast<double>(cells));
  return static_cast<std::int64_t>(ring_[ring] + std::min(cell, cells - 1));
}

// To be called for one of the two ends only: counts of pairs seen twice would vary more.
void Differentials::CountDirection(const Eigen::Vector2d& difference) {
  const std::int64_t cell = CellOf(difference);
  if (cell >= 0) cells_[static_cast<std::size_t>(cell)] += 1.0;
}

void Differentials::AddSurface(const Surface& surface, const Density& density,
                               std::span<const SurfacePoint> samples, const Parallel& parallel,
                               Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  ++sets_;
  if (samples.empty()) return;
  const Content content = Place(surface, density, samples);
  const auto count = static_cast<double>(samples.size());
  const double faces_a_disc = kPi * reach_ * reach_ / count * surface.face_count() + 1.0;
  const double most = std::min(static_cast<double>(kMostCenters), kMostFaces / faces_a_disc);
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(count / most)));
  // Where the density varies, the mean of two spacings may be larger than that of the centre.
  const double margin = density.uniform() ? 1.0 : 1.5;
  const auto centers = static_cast<std::int64_t>((samples.size() + stride - 1) / stride);
  // What is seen from a piece of the centres; added in the order of pieces.
  struct Seen {
    std::vector<double> pairs;
    std::vector<double> expected;
    std::vector<std::int32_t> cells;   // Of each pair, as long as they are few,
    std::vector<std::int32_t> counts;  // else how often each cell was seen.
  };
  // On a crumpled surface a disc may hold nearly all samples.
  const auto compact = [&](Seen& seen) {
    seen.counts.resize(cells_.size(), 0);
    for (const std::int32_t cell : seen.cells) ++seen.counts[static_cast<std::size_t>(cell)];
    seen.cells.clear();
  };
  std::vector<Seen> pieces(static_cast<std::size_t>((centers + kPiece - 1) / kPiece));
  const auto look = [&](std::size_t i, GeodesicDisc& disc, Interrupt& own, Seen& seen) {
    const SurfacePoint& center = samples[i];
    const double spacing = std::sqrt(
        surface.area() / count / density.At(center.face, center.weights, surface.area() / count));
    const double radius = margin * reach_ * spacing;
    for (const FlatFace& flat : disc.Unfold(center, radius, &own)) {
      const auto f = static_cast<std::size_t>(flat.face);
      if (own.RequestedAfter(1 +
                             static_cast<std::int64_t>(content.start[f + 1] - content.start[f]) /
                                 kItemsAUnit)) {
        return;
      }
      for (std::size_t k = content.start[f]; k < content.start[f + 1]; ++k) {
        const Content::Item& item = content.items[k];
        if (item.index == static_cast<std::int32_t>(i)) continue;
        const Eigen::Vector2d place = flat.At(item.weights);
        const double squared = place.squaredNorm();
        if (!(squared < radius * radius)) continue;
        const double scale = 2.0 / (spacing + item.spacing);
        const auto bin = static_cast<std::size_t>(std::sqrt(squared) * scale / kBinWidth);
        if (bin < seen.pairs.size()) {
          (item.index >= 0 ? seen.pairs[bin] : seen.expected[bin]) +=
              item.index >= 0 ? 1.0 : item.samples;
        }
        if (item.index <= static_cast<std::int32_t>(i)) continue;
        const std::int64_t cell = CellOf(place * scale);
        if (cell >= 0) seen.cells.push_back(static_cast<std::int32_t>(cell));
      }
    }
  };
  parallel.ForRanges(centers, kPiece, [&, stop = *interrupt](std::int64_t first, std::int64_t end) {
    Interrupt own = stop;
    if (own.Requested()) return;
    Seen& seen = pieces[static_cast<std::size_t>(first / kPiece)];
    seen.pairs.assign(pairs_.size(), 0.0);
    seen.expected.assign(expected_.size(), 0.0);
    GeodesicDisc disc(surface);
    for (std::int64_t c = first; c < end && !own.Requested(); ++c) {
      look(static_cast<std::size_t>(c) * stride, disc, own, seen);
      if (seen.cells.size() > kMostPairs) compact(seen);
    }
  });
  if (interrupt->Requested()) return;
  centers_ += static_cast<double>(centers);
  for (const Seen& seen : pieces) {
    for (std::size_t bin = 0; bin < pairs_.size(); ++bin) {
      pairs_[bin] += seen.pairs[bin];
      expected_[bin] += seen.expected[bin];
    }
    for (const std::int32_t cell : seen.cells) cells_[static_cast<std::size_t>(cell)] += 1.0;
    for (std::size_t cell = 0; cell < seen.counts.size(); ++cell) cells_[cell] += seen.counts[cell];
  }
}

void Differentials::AddTorus(std::span<const Eigen::Vector2d> positions,
                             const Eigen::Vector2d& extents) {
  ++sets_;
  const double unit = std::sqrt(static_cast<double>(positions.size()) / extents.prod());
  // In stripes along x, so that distant pairs are not looked at.
  std::vector<Eigen::Vector2d> sorted;
  sorted.reserve(positions.size());
  for (const Eigen::Vector2d& p : positions) {
    sorted.push_back(
        (p.array() - (p.array() / extents.array()).floor() * extents.array()).matrix());
  }
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  const double reach = std::min(reach_ / unit, 0.5 * extents.minCoeff());
  const std::size_t count = sorted.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t step = 1; step < count; ++step) {
      const std::size_t j = (i + step) % count;
      Eigen::Vector2d difference = sorted[j] - sorted[i];
      if (j < i) difference.x() += extents.x();
      if (difference.x() > reach) break;
      difference.y() -= std::round(difference.y() / extents.y()) * extents.y();
      if (difference.squaredNorm() >= reach * reach) continue;
      CountDistance(difference.norm() * unit, 2.0);
      CountDirection(difference * unit);
    }
  }
  centers_ += static_cast<double>(count);
  for (std::size_t bin = 0; bin < expected_.size(); ++bin) {
    const double from = static_cast<double>(bin) * kBinWidth;
    if (from + kBinWidth > reach * unit * (1.0 + 1e-9)) break;
    expected_[bin] += static_cast<double>(count) * kPi * kBinWidth * (2.0 * from + kBinWidth);
  }
}

Curve Differentials::RadialMean(double width) const {
  const auto merged = static_cast<std::size_t>(std::lround(width / kBinWidth));
  // What white noise would have is smooth in the distance but for the noise of the points at which
  // the area is counted: its ratio to the plane's is averaged over a quarter of a spacing.
  const auto smooth = static_cast<std::size_t>(std::lround(0.25 / kBinWidth));
  std::vector<double> sums = {0.0};
  for (const double expected : expected_) sums.push_back(sums.back() + expected);
  const auto ring = [](std::size_t from, std::size_t to) {
    const auto a = static_cast<double>(from) * kBinWidth;
    const auto b = static_cast<double>(to) * kBinWidth;
    return kPi * (b * b - a * a);
  };
  Curve curve;
  for (std::size_t bin = 0; bin + merged <= pairs_.size(); bin += merged) {
    double found = 0.0;
    for (std::size_t k = bin; k < bin + merged; ++k) found += pairs_[k];
    const std::size_t from = bin > smooth / 2 ? bin - smooth / 2 : 0;
    std::size_t to = std::min(bin + merged + smooth / 2, pairs_.size());
    // Of samples at the corners of faces no point that stands for the area is very near.
    while (to < pairs_.size() && !(sums[to] > sums[from])) ++to;
    const double expected = (sums[to] - sums[from]) / ring(from, to) * ring(bin, bin + merged);
    if (!(expected > 0.0)) break;
    curve.x.push_back((static_cast<double>(bin) + 0.5 * static_cast<double>(merged)) * kBinWidth);
    curve.y.push_back(found / expected);
  }
  return curve;
}

Curve Differentials::Anisotropy() const {
  Curve curve;
  for (std::size_t j = 0; j + 1 < ring_.size(); ++j) {
    const std::size_t cells = ring_[j + 1] - ring_[j];
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t k = ring_[j]; k < ring_[j + 1]; ++k) {
      sum += cells_[k];
      squares += cells_[k] * cells_[k];
    }
    const double mean = sum / static_cast<double>(cells);
    if (mean < 0.1) continue;
    const double variance =
        (squares - sum * mean) / static_cast<double>(std::max<std::size_t>(cells - 1, 1));
    curve.x.push_back((static_cast<double>(j) + 0.5) * kRingWidth);
    curve.y.push_back(10.0 * std::log10(std::max(variance, 1e-12) / mean / sets_));
  }
  return curve;
}

std::vector<double> Differentials::AnisotropyNoise(const Curve& anisotropy) const {
  std::vector<double> noise;
  for (const double x : anisotropy.x) {
    const auto j = static_cast<std::size_t>(x / kRingWidth);
    const auto cells = static_cast<double>(ring_[j + 1] - ring_[j]);
    double sum = 0.0;
    for (std::size_t k = ring_[j]; k < ring_[j + 1]; ++k) sum += cells_[k];
    // Of the variance over the mean of Poisson counts of mean m: sqrt(2 / cells + 1 / (cells m)).
    const double pairs = sum / cells;
    noise.push_back(10.0 / std::numbers::ln10 * std::sqrt((2.0 + 1.0 / pairs) / cells));
  }
  return noise;
}

Curve Differentials::PowerSpectrum(double last, double step) const {
  std::vector<double> excess(pairs_.size());
  for (std::size_t bin = 0; bin < pairs_.size(); ++bin) {
    const double r = (static_cast<double>(bin) + 0.5) * kBinWidth;
    const double weight = expected_[bin] > 0.0 || pairs_[bin] > 0.0 ? Window(r / reach_) : 0.0;
    excess[bin] = centers_ > 0.0 ? (pairs_[bin] - expected_[bin]) * weight / centers_ : 0.0;
  }
  Curve curve;
  const auto count = static_cast<std::size_t>(std::floor(last / step + 0.5));
  for (std::size_t i = 1; i <= count; ++i) {
    const double frequency = static_cast<double>(i) * step;
    double power = 1.0;
    for (std::size_t bin = 0; bin < excess.size(); ++bin) {
      const double r = (static_cast<double>(bin) + 0.5) * kBinWidth;
      power += excess[bin] * ::j0(2.0 * kPi * frequency * r);
    }
    curve.x.push_back(frequency);
    curve.y.push_back(power);
  }
  return curve;
}

}  // namespace ccst::analysis
