#include "tests/benchmark/subjects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "absl/strings/str_cat.h"
#include "core/random/random.h"
#include "tests/support/shapes.h"

namespace ccst::benchmarks {
namespace {

constexpr double kLargeRadius = 1.0;
constexpr double kSmallRadius = 0.4;
constexpr double kJitter = 0.3;  // Of a vertex, in edges.

/// Quads along the small circle so that they are almost square.
int Across(std::int64_t faces) {
  const double ratio = kLargeRadius / kSmallRadius;
  return std::max(3, static_cast<int>(std::lround(std::sqrt(faces / (2.0 * ratio)))));
}

int Around(std::int64_t faces) {
  return std::max(4, static_cast<int>(std::lround(faces / (2.0 * Across(faces)))));
}

TriangleMesh Torus(std::int64_t faces) {
  return shapes::Torus(kLargeRadius, kSmallRadius, Around(faces), Across(faces));
}

/// Height of the bumps at `p`: three wavelengths, each half as high as the one before.
double Bump(const Eigen::Vector3d& p) {
  double height = 0.0;
  double amplitude = 0.03;
  double frequency = 5.0;
  for (int octave = 0; octave < 3; ++octave) {
    height += amplitude * std::sin(frequency * p.x() + octave) *
              std::sin(frequency * p.y() + 2.0 * octave) * std::cos(frequency * p.z());
    amplitude *= 0.5;
    frequency *= 2.0;
  }
  return height;
}

TriangleMesh Soup(std::int64_t faces) {
  TriangleMesh mesh = shapes::Unwelded(Scan(faces));
  for (std::size_t f = 0; f < mesh.faces.size(); f += 9) {
    std::swap(mesh.faces[f][1], mesh.faces[f][2]);
  }
  return mesh;
}

}  // namespace

TriangleMesh Scan(std::int64_t faces) {
  TriangleMesh mesh = Torus(faces);
  const double edge = 2.0 * std::numbers::pi * kSmallRadius / Across(faces);
  const CounterRandom random(1, 0);
  std::uint64_t draw = 0;
  for (Eigen::Vector3d& p : mesh.positions) {
    const Eigen::Vector3d axis = kLargeRadius * Eigen::Vector3d(p.x(), p.y(), 0.0).normalized();
    const Eigen::Vector3d normal = (p - axis).normalized();
    Eigen::Vector3d jitter;
    for (double& x : jitter) x = random.Uniform(draw++) - 0.5;
    p += kJitter * edge * (jitter - normal * normal.dot(jitter)) + Bump(p) * normal;
  }
  return mesh;
}

absl::StatusOr<TriangleMesh> MakeSubject(const std::string& name, std::int64_t faces) {
  if (name == "torus") return Torus(faces);
  if (name == "scan") return Scan(faces);
  if (name == "saddle") {
    return shapes::Saddle(static_cast<int>(std::lround(std::sqrt(faces / 2.0))));
  }
  if (name == "soup") return Soup(faces);
  return absl::InvalidArgumentError(
      absl::StrCat("no shape '", name, "'; there are torus, scan, saddle and soup"));
}

std::vector<Eigen::Vector3d> PointsNear(const TriangleMesh& mesh, std::int64_t count) {
  const double edge = (mesh.positions[mesh.faces[0][0]] - mesh.positions[mesh.faces[0][1]]).norm();
  const CounterRandom random(2, 0);
  std::vector<Eigen::Vector3d> points(count);
  std::uint64_t draw = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto vertex = static_cast<std::size_t>(
        static_cast<double>(i) * static_cast<double>(mesh.positions.size()) / count);
    Eigen::Vector3d offset;
    for (double& x : offset) x = random.Uniform(draw++) - 0.5;
    points[i] = mesh.positions[vertex] + edge * offset;
  }
  return points;
}

std::vector<double> RisingValues(const TriangleMesh& mesh) {
  double low = mesh.positions[0].x();
  double high = low;
  for (const Eigen::Vector3d& p : mesh.positions) {
    low = std::min(low, p.x());
    high = std::max(high, p.x());
  }
  std::vector<double> values;
  values.reserve(3 * mesh.faces.size());
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const std::int32_t v : face) {
      values.push_back(1.0 + 3.0 * (mesh.positions[v].x() - low) / (high - low));
    }
  }
  return values;
}

}  // namespace ccst::benchmarks
