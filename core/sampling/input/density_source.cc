#include "core/sampling/input/density_source.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/portable_math.h"
#include "core/base/sort_in_runs.h"
#include "core/base/status.h"
#include "core/mesh/attributes.h"
#include "core/surface/curvature.h"

namespace ccst::internal {
namespace {

/// Share of the area whose curvatures count as they are.
constexpr double kCurvatureQuantile = 0.99;
/// Times that curvatures are averaged with those around: one vertex's is an estimate from its ring,
/// and noise would be followed like shape.
constexpr int kCurvatureSmoothing = 3;

absl::Status Invalid(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDensityInvalid, message);
}

absl::Status Stopped(const Interrupt& interrupt) {
  return interrupt.Error("the density was measured");
}

/// Component `k` of an attribute of the mesh at a corner of a face of the surface.
double ValueAt(const TriangleMesh& mesh, const SourceMap& sources, const Attribute& attribute,
               std::int32_t face, int corner, int k) {
  const std::int32_t source = sources.Face(face);
  const Eigen::Vector3d weights = sources.Corner(face, corner);
  double value = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0.0) continue;
    const std::size_t row =
        attribute.per_corner ? 3 * static_cast<std::size_t>(source) + i : mesh.faces[source][i];
    value += weights[i] * attribute.values[row * attribute.components + k];
  }
  return value;
}

bool IsNumber(const Attribute& attribute) {
  return attribute.kind == AttributeKind::kScalar || attribute.kind == AttributeKind::kLabel;
}

std::string NamesOfNumbers(const TriangleMesh& mesh) {
  std::vector<std::string> names;
  for (const Attribute& attribute : mesh.attributes) {
    if (IsNumber(attribute)) names.push_back(attribute.name);
  }
  return names.empty() ? "it has none" : absl::StrCat("it has ", absl::StrJoin(names, ", "));
}

absl::StatusOr<Density> FromAttribute(const TriangleMesh& mesh, const SourceMap& sources,
                                      const Surface& surface, const DensityOptions& options,
                                      Interrupt* interrupt) {
  const Attribute* found = FindAttribute(mesh.attributes, options.attribute);
  if (found == nullptr || !IsNumber(*found) || found->components != 1) {
    return Invalid(absl::StrCat("the mesh has no scalar attribute named ", options.attribute, "; ",
                                NamesOfNumbers(mesh)));
  }
  std::vector<double> corners(3 * static_cast<std::size_t>(surface.face_count()));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    if (interrupt->RequestedAt(f)) return Stopped(*interrupt);
    for (int k = 0; k < 3; ++k) {
      const double value = ValueAt(mesh, sources, *found, f, k, 0);
      if (!(value >= 0.0) || !std::isfinite(value)) {
        return Invalid(absl::StrCat("attribute ", options.attribute, " is ", value, " on face ",
                                    sources.Face(f), "; a density must be finite and >= 0"));
      }
      corners[3 * static_cast<std::size_t>(f) + k] = PortablePow(value, options.exponent);
    }
  }
  return Density::Linear(surface, std::move(corners), options.max_contrast, interrupt);
}

double Measure(const PrincipalCurvatures& curvature, CurvatureMeasure measure) {
  switch (measure) {
    case CurvatureMeasure::kGaussian:
      return std::sqrt(std::abs(curvature.k1 * curvature.k2));
    case CurvatureMeasure::kMean:
      return 0.5 * std::abs(curvature.k1 + curvature.k2);
    case CurvatureMeasure::kMaximum:
      return std::max(std::abs(curvature.k1), std::abs(curvature.k2));
  }
  return 0.0;
}

/// Mean of each vertex's value, which counts half, and those of its faces' corners by area.
/// Unfinished when `interrupt` was requested.
std::vector<double> RingMeans(const Surface& surface, const std::vector<double>& values,
                              Interrupt* interrupt) {
  std::vector<double> sums(values.size(), 0.0);
  std::vector<double> weights(values.size(), 0.0);
  for (std::int32_t f = 0; f < surface.face_count() && !interrupt->RequestedAt(f); ++f) {
    const Eigen::Vector3i& face = surface.faces()[f];
    const double area = surface.face_areas()[f];
    const double sum = values[face[0]] + values[face[1]] + values[face[2]];
    for (int k = 0; k < 3; ++k) {
      sums[face[k]] += area * (sum - values[face[k]]);
      weights[face[k]] += 2.0 * area;
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v) {
    sums[v] = weights[v] > 0.0 ? 0.5 * (values[v] + sums[v] / weights[v]) : values[v];
  }
  return sums;
}

/// The value that `share` of the total weight does not exceed; some value when `interrupt` was
/// requested.
double Quantile(const std::vector<double>& values, const std::vector<double>& weights, double share,
                Interrupt* interrupt) {
  std::vector<std::int32_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  SortInRuns(order.begin(), order.end(), interrupt, [&](std::int32_t a, std::int32_t b) {
    return values[a] != values[b] ? values[a] < values[b] : a < b;
  });
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  double passed = 0.0;
  for (const std::int32_t i : order) {
    passed += weights[i];
    if (passed >= share * total) return values[i];
  }
  return values[order.back()];
}

absl::StatusOr<Density> FromCurvature(const Surface& surface, const DensityOptions& options,
                                      Interrupt* interrupt) {
  std::vector<double> measured(surface.vertex_count());
  std::vector<double> areas(surface.vertex_count(), 0.0);
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) areas[surface.faces()[f][k]] += surface.face_areas()[f] / 3.0;
  }
  for (std::int32_t v = 0; v < surface.vertex_count(); ++v) {
    if (interrupt->RequestedAt(v)) return Stopped(*interrupt);
    const std::int32_t h = surface.outgoing()[v];
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();
    weights[h % 3] = 1.0;
    measured[v] = Measure(Diagonalise(surface.ShapeAt(h / 3, weights), surface.normals()[v]),
                          options.measure);
  }
  for (int step = 0; step < kCurvatureSmoothing; ++step) {
    measured = RingMeans(surface, measured, interrupt);
    if (interrupt->Requested()) return Stopped(*interrupt);
  }
  const double largest = Quantile(measured, areas, kCurvatureQuantile, interrupt);
  if (interrupt->Requested()) return Stopped(*interrupt);
  // A plane, or a developable surface under its Gaussian curvature.
  constexpr double kFlat = 1e-6;
  if (!(largest > kFlat)) {
    return Invalid("the surface has no curvature of the wanted measure; choose another density");
  }
  std::vector<double> corners(3 * static_cast<std::size_t>(surface.face_count()));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const double value = std::min(measured[surface.faces()[f][k]], largest) / largest;
      corners[3 * static_cast<std::size_t>(f) + k] = PortablePow(value, options.exponent);
    }
  }
  return Density::Linear(surface, std::move(corners), options.max_contrast, interrupt);
}

absl::StatusOr<Density> FromTexture(const TriangleMesh& mesh, const SourceMap& sources,
                                    const Surface& surface, const DensityOptions& options,
                                    Interrupt* interrupt) {
  const auto found =
      std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [](const Attribute& attribute) {
        return attribute.kind == AttributeKind::kTextureCoordinates && attribute.components == 2;
      });
  if (found == mesh.attributes.end()) {
    return Invalid("a texture density needs texture coordinates, and the mesh has none");
  }
  std::vector<Eigen::Vector2d> coordinates(3 * static_cast<std::size_t>(surface.face_count()));
  for (std::int32_t f = 0; f < surface.face_count(); ++f) {
    if (interrupt->RequestedAt(f)) return Stopped(*interrupt);
    for (int k = 0; k < 3; ++k) {
      coordinates[3 * static_cast<std::size_t>(f) + k] = {ValueAt(mesh, sources, *found, f, k, 0),
                                                          ValueAt(mesh, sources, *found, f, k, 1)};
    }
  }
  if (options.image == nullptr || options.image->values.empty()) {
    return Invalid("the image of the texture density is empty");
  }
  Image image = *options.image;
  for (float& value : image.values) {
    if (interrupt->RequestedAfter(1)) return Stopped(*interrupt);
    const double grey = std::clamp(static_cast<double>(value), 0.0, 1.0);
    value = static_cast<float>(
        PortablePow(options.bright_is_dense ? grey : 1.0 - grey, options.exponent));
  }
  return Density::Textured(surface, coordinates, std::move(image), options.max_contrast, interrupt);
}

}  // namespace

absl::StatusOr<Density> MakeDensity(const TriangleMesh& mesh, const SourceMap& sources,
                                    const Surface& surface, const DensityOptions& options,
                                    Interrupt* interrupt) {
  Interrupt never;
  if (interrupt == nullptr) interrupt = &never;
  switch (options.source) {
    case DensitySource::kUniform:
      break;
    case DensitySource::kAttribute:
      return FromAttribute(mesh, sources, surface, options, interrupt);
    case DensitySource::kCurvature:
      return FromCurvature(surface, options, interrupt);
    case DensitySource::kTexture:
      return FromTexture(mesh, sources, surface, options, interrupt);
  }
  return Density::Uniform(surface);
}

}  // namespace ccst::internal
