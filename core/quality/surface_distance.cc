#include "core/quality/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include <Eigen/Geometry>

#include "core/quality/capacity.h"

namespace ccst::quality {
namespace {

constexpr double kDefaultPoints = 1e5;
// No more points than these, or two a face.
constexpr double kMostPoints = 2e7;
// No face gets more rows, or points in a row: a needle shall not ask for billions.
constexpr double kMaxSteps = 2000.0;
// Faces or triangles are cut into this many pieces for threads, or more where they are many.
constexpr std::int64_t kPieces = 64;
constexpr std::int64_t kLargestPiece = 1024;

// Collects weighted squares and the largest of distances to one tree.
class Accumulator {
 public:
  explicit Accumulator(const TriangleTree& tree) : tree_(&tree) {}

  void Add(const Eigen::Vector3d& point, double weight) {
    const double distance = tree_->FindClosest(point).distance;
    largest_ = std::max(largest_, distance);
    squares_ += weight * distance * distance;
    weights_ += weight;
  }
  // What was collected after this.
  void Append(const Accumulator& other) {
    largest_ = std::max(largest_, other.largest_);
    squares_ += other.squares_;
    weights_ += other.weights_;
  }
  OneSidedDistance Result() const {
    return {largest_, weights_ > 0.0 ? std::sqrt(squares_ / weights_) : 0.0};
  }

 private:
  const TriangleTree* tree_;
  double largest_ = 0.0;
  double squares_ = 0.0;
  double weights_ = 0.0;
};

// Adds add(i, accumulator) for all i in [0, count), in pieces that follow from `count` alone.
template <typename Add>
void AddAll(std::int64_t count, const Parallel& parallel, const TriangleTree& tree, const Add& add,
            Accumulator& out) {
  const std::int64_t size = std::clamp<std::int64_t>(count / kPieces, 1, kLargestPiece);
  std::vector<Accumulator> pieces((count + size - 1) / size, Accumulator(tree));
  parallel.ForRanges(count, size, [&](std::int64_t first, std::int64_t end) {
    Accumulator& piece = pieces[static_cast<std::size_t>(first / size)];
    for (std::int64_t i = first; i < end; ++i) add(static_cast<std::size_t>(i), piece);
  });
  for (const Accumulator& piece : pieces) out.Append(piece);
}

int Steps(double length, double spacing) {
  return static_cast<int>(std::clamp(std::ceil(length / spacing), 1.0, kMaxSteps));
}

// A triangle whose longest side is its base: rows parallel to it need few points on slivers.
struct BasedTriangle {
  BasedTriangle(const TriangleMesh& mesh, std::size_t f)
      : a(mesh.positions[mesh.faces[f][0]]),
        b(mesh.positions[mesh.faces[f][1]]),
        c(mesh.positions[mesh.faces[f][2]]) {
    const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
    if (bc >= ab && bc >= ca) {
      std::tie(a, b, c) = std::tuple(b, c, a);
    } else if (ca >= ab && ca >= bc) {
      std::tie(a, b, c) = std::tuple(c, a, b);
    }
    base = (b - a).norm();
    if (base > 0.0) height = (b - a).cross(c - a).norm() / base;
  }

  Eigen::Vector3d a, b, c;
  double base = 0.0;
  double height = 0.0;
};

// The spacing that gives about kDefaultPoints, wider where needles would ask for very many more.
double DefaultSpacing(const TriangleMesh& surface) {
  double spacing = std::sqrt(TotalArea(surface.positions, surface.faces) / kDefaultPoints);
  const double most = std::max(kMostPoints, 2.0 * static_cast<double>(surface.faces.size()));
  for (; spacing > 0.0; spacing *= 2.0) {
    double points = 0.0;
    for (std::size_t f = 0; f < surface.faces.size(); ++f) {
      const BasedTriangle face(surface, f);
      points += static_cast<double>(Steps(face.height, spacing)) * Steps(face.base, spacing);
    }
    if (points <= most) break;
  }
  return spacing;
}

// Visits the middle points of a grid over a triangle; each stands for an equal share of the
// area of its row.
void AddFace(const BasedTriangle& face, double spacing, Accumulator& out) {
  const auto& [a, b, c, base, height] = face;
  if (!(base > 0.0)) return;
  const int rows = Steps(height, spacing);
  for (int row = 0; row < rows; ++row) {
    const double t = (row + 0.5) / rows;
    const double width = (1.0 - t) * base;
    const int columns = Steps(width, spacing);
    const Eigen::Vector3d begin = a + t * (c - a);
    const Eigen::Vector3d end = b + t * (c - b);
    for (int column = 0; column < columns; ++column) {
      const double s = (column + 0.5) / columns;
      out.Add(begin + s * (end - begin), width * height / rows / columns);
    }
  }
}

}  // namespace

double LargestDistance(std::span<const Eigen::Vector3d> points, const TriangleTree& surface) {
  double largest = 0.0;
  for (const Eigen::Vector3d& point : points) {
    largest = std::max(largest, surface.FindClosest(point).distance);
  }
  return largest;
}

SurfaceDistanceFigures MeasureSurfaceDistance(const TriangleMesh& surface,
                                              const TriangleTree& surface_tree,
                                              std::span<const Eigen::Vector3d> positions,
                                              std::span<const Eigen::Vector3i> triangles,
                                              double spacing, const Parallel& parallel) {
  if (!(spacing > 0.0)) spacing = DefaultSpacing(surface);
  const TriangleTree sample_tree(positions, triangles);
  Accumulator from_surface(sample_tree);
  AddAll(
      static_cast<std::int64_t>(surface.faces.size()), parallel, sample_tree,
      [&](std::size_t f, Accumulator& piece) {
        AddFace(BasedTriangle(surface, f), spacing, piece);
      },
      from_surface);
  std::vector<std::uint8_t> used(surface.positions.size(), 0);
  for (const Eigen::Vector3i& t : surface.faces) {
    for (const int v : t) used[v] = 1;
  }
  AddAll(
      static_cast<std::int64_t>(used.size()), parallel, sample_tree,
      [&](std::size_t v, Accumulator& piece) {
        if (used[v] != 0) piece.Add(surface.positions[v], 0.0);
      },
      from_surface);

  // Vertices, midpoints and centroid with the weights of the seven-point rule, exact for cubics.
  Accumulator from_samples(surface_tree);
  AddAll(
      static_cast<std::int64_t>(triangles.size()), parallel, surface_tree,
      [&](std::size_t i, Accumulator& piece) {
        const Eigen::Vector3i& t = triangles[i];
        const Eigen::Vector3d& a = positions[t[0]];
        const Eigen::Vector3d& b = positions[t[1]];
        const Eigen::Vector3d& c = positions[t[2]];
        const double area = 0.5 * (b - a).cross(c - a).norm();
        for (const Eigen::Vector3d* corner : {&a, &b, &c}) piece.Add(*corner, area / 20.0);
        for (const Eigen::Vector3d& middle :
             {Eigen::Vector3d((a + b) / 2.0), Eigen::Vector3d((b + c) / 2.0),
              Eigen::Vector3d((c + a) / 2.0)}) {
          piece.Add(middle, area * 2.0 / 15.0);
        }
        piece.Add((a + b + c) / 3.0, area * 9.0 / 20.0);
      },
      from_samples);

  SurfaceDistanceFigures figures;
  figures.surface_to_samples = from_surface.Result();
  figures.samples_to_surface = from_samples.Result();
  figures.hausdorff =
      std::max(figures.surface_to_samples.largest, figures.samples_to_surface.largest);
  figures.rms = std::max(figures.surface_to_samples.rms, figures.samples_to_surface.rms);
  return figures;
}

}  // namespace ccst::quality
