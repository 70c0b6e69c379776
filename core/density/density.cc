#include "core/density/density.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/assert.h"
#include "core/base/portable_math.h"
#include "core/base/status.h"

namespace ccst {
namespace {

/// A face is cut up until its parts cover at most this many pixels, but at most this often, and
/// with at most this many parts altogether, shared out by area.
constexpr double kPartPixels = 2.0;
constexpr int kDeepest = 8;
constexpr double kMostMeans = 1 << 24;
/// How many parts make one unit of work of an Interrupt.
constexpr std::int64_t kPartsAUnit = 16;

const std::array<Eigen::Vector3d, 3> kWholeFace = {
    Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};

/// Where the parts of a level >= 1 start in a tree that has them level by level.
std::size_t LevelStart(int level) { return ((std::size_t{1} << (2 * level)) - 4) / 3; }

/// The four congruent parts of a triangle, in the order of a curve that enters at the first corner.
/// Source: Basu and Owen, "Low discrepancy constructions in the triangle", SINUM 53(2), 2015.
std::array<std::array<Eigen::Vector3d, 3>, 4> Quarter(const std::array<Eigen::Vector3d, 3>& part) {
  const auto& [a, b, c] = part;
  const Eigen::Vector3d ab = 0.5 * (a + b);
  const Eigen::Vector3d bc = 0.5 * (b + c);
  const Eigen::Vector3d ca = 0.5 * (c + a);
  return {{{a, ab, ca}, {ab, b, bc}, {ab, bc, ca}, {ca, bc, c}}};
}

/// One of them.
std::array<Eigen::Vector3d, 3> QuarterAt(const std::array<Eigen::Vector3d, 3>& part, int digit) {
  const auto& [a, b, c] = part;
  switch (digit) {
    case 0:
      return {a, 0.5 * (a + b), 0.5 * (c + a)};
    case 1:
      return {0.5 * (a + b), b, 0.5 * (b + c)};
    case 2:
      return {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)};
    default:
      return {0.5 * (c + a), 0.5 * (b + c), c};
  }
}

Eigen::Vector3d Center(const std::array<Eigen::Vector3d, 3>& part) {
  return (part[0] + part[1] + part[2]) / 3.0;
}

/// The same image at half the size; pixels beyond an odd edge are repeated.
Image Halve(const Image& image) {
  Image half;
  half.width = (image.width + 1) / 2;
  half.height = (image.height + 1) / 2;
  half.values.resize(static_cast<std::size_t>(half.width) * half.height);
  const auto at = [&](std::int32_t x, std::int32_t y) {
    return image.values[static_cast<std::size_t>(std::min(y, image.height - 1)) * image.width +
                        std::min(x, image.width - 1)];
  };
  for (std::int32_t y = 0; y < half.height; ++y) {
    for (std::int32_t x = 0; x < half.width; ++x) {
      half.values[static_cast<std::size_t>(y) * half.width + x] =
          0.25F * (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) +
                   at(2 * x + 1, 2 * y + 1));
    }
  }
  return half;
}

/// Bilinear between pixel centres; the image is repeated in both directions.
double Lookup(const Image& image, double u, double v) {
  const double x = (u - std::floor(u)) * image.width - 0.5;
  const double y = (1.0 - (v - std::floor(v))) * image.height - 0.5;
  const double x0 = std::floor(x);
  const double y0 = std::floor(y);
  const auto wrap = [](double i, std::int32_t size) {
    const auto k = static_cast<std::int32_t>(i) % size;
    return static_cast<std::size_t>(k < 0 ? k + size : k);
  };
  const std::size_t left = wrap(x0, image.width);
  const std::size_t right = wrap(x0 + 1.0, image.width);
  const std::size_t top = wrap(y0, image.height) * image.width;
  const std::size_t bottom = wrap(y0 + 1.0, image.height) * image.width;
  const double s = x - x0;
  const double t = y - y0;
  const auto& pixel = image.values;
  return (1.0 - t) * ((1.0 - s) * pixel[top + left] + s * pixel[top + right]) +
         t * ((1.0 - s) * pixel[bottom + left] + s * pixel[bottom + right]);
}

absl::Status CheckContrast(double max_contrast) {
  if (max_contrast > 1.0 && std::isfinite(max_contrast)) return absl::OkStatus();
  return MakeError(
      absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
      absl::StrCat("max_contrast is ", max_contrast, "; it must be finite and over 1"));
}

absl::Status Invalid(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDensityInvalid, message);
}

}  // namespace

Density Density::Uniform(const Surface& surface) {
  Density density;
  density.face_areas_ = surface.face_areas();
  density.face_capacities_ = surface.face_areas();
  density.component_capacities_ = surface.component_areas();
  return density;
}

absl::StatusOr<Density> Density::Linear(const Surface& surface, std::vector<double> corners,
                                        double max_contrast, Interrupt* interrupt) {
  CCST_RETURN_IF_ERROR(CheckContrast(max_contrast));
  double largest = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!(corners[i] >= 0.0) || !std::isfinite(corners[i])) {
      return Invalid(absl::StrCat("the density is ", corners[i], " at corner ", i % 3, " of face ",
                                  i / 3, "; it must be finite and not negative"));
    }
    if (surface.face_areas()[i / 3] > 0.0) largest = std::max(largest, corners[i]);
  }
  if (!(largest > 0.0)) return Invalid("the density is 0 everywhere; some of it must be positive");
  // Far from the limits of doubles, whatever the unit.
  for (double& value : corners) value = std::max(value / largest, 1.0 / max_contrast);
  Density density;
  density.corners_ = std::move(corners);
  CCST_RETURN_IF_ERROR(density.Normalise(surface, interrupt));
  return density;
}

absl::StatusOr<Density> Density::Textured(const Surface& surface,
                                          const std::vector<Eigen::Vector2d>& coordinates,
                                          Image image, double max_contrast, Interrupt* interrupt) {
  CCST_RETURN_IF_ERROR(CheckContrast(max_contrast));
  float largest = 0.0F;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (!(image.values[i] >= 0.0F) || !std::isfinite(image.values[i])) {
      return Invalid(absl::StrCat("the image is ", image.values[i], " at pixel (", i % image.width,
                                  ", ", i / image.width, "); it must be finite and not negative"));
    }
    largest = std::max(largest, image.values[i]);
  }
  if (!(largest > 0.0F)) return Invalid("the density is 0 everywhere; some of it must be positive");
  Density density;
  density.coordinates_.resize(coordinates.size());
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    // Beyond this no fraction is left of them.
    if (!(coordinates[i].cwiseAbs().maxCoeff() < 1e6)) {
      return Invalid(absl::StrCat("the texture coordinates of corner ", i % 3, " of face ", i / 3,
                                  " are (", coordinates[i][0], ", ", coordinates[i][1],
                                  "); they must be finite and below 1e6"));
    }
    density.coordinates_[i] = coordinates[i].cast<float>();
  }
  const double pixels = static_cast<double>(image.width) * image.height;
  density.pyramid_.push_back(std::move(image));
  for (float& value : density.pyramid_[0].values) value /= largest;
  while (density.pyramid_.back().width > 1 || density.pyramid_.back().height > 1) {
    density.pyramid_.push_back(Halve(density.pyramid_.back()));
  }
  density.floor_ = 1.0 / max_contrast;
  density.pixels_per_area_.resize(surface.face_count());
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    const Eigen::Vector2d a = coordinates[3 * f + 1] - coordinates[3 * f];
    const Eigen::Vector2d b = coordinates[3 * f + 2] - coordinates[3 * f];
    const double covered = 0.5 * std::abs(a[0] * b[1] - a[1] * b[0]) * pixels;
    const double area = surface.face_areas()[f];
    density.pixels_per_area_[f] = area > 0.0 ? static_cast<float>(covered / area) : 0.0F;
  }
  CCST_RETURN_IF_ERROR(density.Normalise(surface, interrupt));
  return density;
}

double Density::At(std::int32_t face, const Eigen::Vector3d& weights, double area) const {
  CCST_ASSERT(face >= 0 && static_cast<std::size_t>(face) < face_capacities_.size());
  return uniform() ? 1.0 : scale_ * Value(face, weights, area);
}

double Density::Value(std::int32_t face, const Eigen::Vector3d& weights, double area) const {
  if (pyramid_.empty()) {
    return weights[0] * corners_[3 * face] + weights[1] * corners_[3 * face + 1] +
           weights[2] * corners_[3 * face + 2];
  }
  const double u = weights[0] * coordinates_[3 * face][0] +
                   weights[1] * coordinates_[3 * face + 1][0] +
                   weights[2] * coordinates_[3 * face + 2][0];
  const double v = weights[0] * coordinates_[3 * face][1] +
                   weights[1] * coordinates_[3 * face + 1][1] +
                   weights[2] * coordinates_[3 * face + 2][1];
  // Pixels of the level looked up are twice as wide as the footprint: patterns near its own size
  // would alias.
  const double pixels = 4.0 * area * pixels_per_area_[face];
  const double level = std::min(pixels > 1.0 ? 0.5 * PortableLog2(pixels) : 0.0,
                                static_cast<double>(pyramid_.size() - 1));
  const auto low = static_cast<std::size_t>(level);
  double value = Lookup(pyramid_[low], u, v);
  if (level > static_cast<double>(low)) {
    value += (level - static_cast<double>(low)) * (Lookup(pyramid_[low + 1], u, v) - value);
  }
  return std::max(value, floor_);
}

double Density::BuildTree(std::int32_t face, const std::array<Eigen::Vector3d, 3>& part, int level,
                          std::size_t index) {
  const double share = PortableExp2(-2.0 * level);
  double mean = 0.0;
  if (level == depths_[face]) {
    mean = Value(face, Center(part), share * face_areas_[face]);
  } else {
    const auto quarters = Quarter(part);
    for (std::size_t k = 0; k < 4; ++k) {
      mean += 0.25 * BuildTree(face, quarters[k], level + 1, 4 * index + k);
    }
  }
  if (level > 0) means_[tree_starts_[face] + LevelStart(level) + index] = static_cast<float>(mean);
  return mean;
}

void Density::PlanTrees(const Surface& surface) {
  depths_.resize(face_areas_.size());
  tree_starts_.resize(face_areas_.size());
  std::size_t nodes = 0;
  for (std::size_t f = 0; f < face_areas_.size(); ++f) {
    const double pixels = face_areas_[f] * pixels_per_area_[f];
    const double allowed = kMostMeans * face_areas_[f] / surface.area();
    int depth = 0;
    while (depth < kDeepest && pixels > kPartPixels * std::ldexp(1.0, 2 * depth) &&
           std::ldexp(1.0, 2 * (depth + 1)) < allowed) {
      ++depth;
    }
    depths_[f] = static_cast<std::int8_t>(depth);
    tree_starts_[f] = nodes;
    nodes += LevelStart(depth + 1);
  }
  means_.resize(nodes);
}

absl::Status Density::Normalise(const Surface& surface, Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  face_areas_ = surface.face_areas();
  if (!pyramid_.empty()) PlanTrees(surface);
  face_capacities_.resize(face_areas_.size());
  double total = 0.0;
  for (std::size_t f = 0; f < face_areas_.size(); ++f) {
    const std::int64_t parts =
        pyramid_.empty() ? 0 : static_cast<std::int64_t>(LevelStart(depths_[f] + 1)) / kPartsAUnit;
    if (interrupt->RequestedAfter(1 + parts)) return interrupt->Error("the density was measured");
    const auto face = static_cast<std::int32_t>(f);
    const double mean =
        pyramid_.empty() ? Value(face, Center(kWholeFace), 0.0) : BuildTree(face, kWholeFace, 0, 0);
    face_capacities_[f] = face_areas_[f] * mean;
    total += face_capacities_[f];
  }
  scale_ = surface.area() / total;
  component_capacities_.assign(surface.component_areas().size(), 0.0);
  for (std::size_t f = 0; f < face_areas_.size(); ++f) {
    face_capacities_[f] *= scale_;
    component_capacities_[surface.face_components()[f]] += face_capacities_[f];
  }
  return absl::OkStatus();
}

Eigen::Vector3d Density::PointAt(std::int32_t face, double t) const {
  std::array<Eigen::Vector3d, 3> part = kWholeFace;
  constexpr int kLevels = 26;  // As many as t has digits.
  // Smaller parts count as uniform.
  const int depth = uniform() ? 0 : pyramid_.empty() ? kDeepest : depths_[face];
  std::size_t index = 0;
  for (int level = 1; level <= kLevels; ++level) {
    int digit;
    if (level > depth) {
      t *= 4.0;
      digit = std::min(3, static_cast<int>(t));
      t -= digit;
    } else {
      const auto quarters = Quarter(part);
      std::array<double, 4> mean;
      double sum = 0.0;
      for (int k = 0; k < 4; ++k) {
        mean[k] = pyramid_.empty() ? Value(face, Center(quarters[k]), 0.0)
                                   : means_[tree_starts_[face] + LevelStart(level) + 4 * index + k];
        sum += mean[k];
      }
      t *= sum;
      digit = 0;
      while (digit < 3 && t >= mean[digit]) t -= mean[digit++];
      t = std::min(t / mean[digit], 1.0 - 0x1.0p-53);
      index = 4 * index + digit;
    }
    part = QuarterAt(part, digit);
  }
  return Center(part);
}

}  // namespace ccst
