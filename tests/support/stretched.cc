#include "tests/support/stretched.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/random/random.h"
#include "tests/support/shapes.h"

namespace ccst::test {
namespace {

constexpr double kDecades = 9.0;

/// Draws one after the other.
class Dice {
 public:
  explicit Dice(std::uint64_t number) : random_(number, 0x73747265746368) {}  // "stretch"

  double Uniform(double low, double high) { return low + (high - low) * random_.Uniform(next_++); }
  std::int64_t Integer(std::int64_t low, std::int64_t high) {
    const auto span = static_cast<std::uint64_t>(high - low + 1);
    return low + static_cast<std::int64_t>(random_.Bits(next_++) % span);
  }
  bool Chance(double probability) { return random_.Uniform(next_++) < probability; }
  double Decades(double low, double high) { return std::pow(10.0, Uniform(low, high)); }

  Eigen::Matrix3d Rotation() {
    const Eigen::Vector4d q(Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1));
    return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
  }

 private:
  CounterRandom random_;
  std::uint64_t next_ = 0;
};

/// Without some of its faces: holes, and often loose pieces.
TriangleMesh Pierced(TriangleMesh mesh, double share, Dice* dice) {
  std::erase_if(mesh.faces, [&](const Eigen::Vector3i&) { return dice->Chance(share); });
  return mesh;
}

/// `count` triangles with one vertex in common, which turn around it on a cone.
TriangleMesh Fan(int count, double height) {
  TriangleMesh mesh;
  mesh.positions.emplace_back(0.0, 0.0, height);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    mesh.faces.emplace_back(0, 1 + i, 1 + (i + 1) % count);
  }
  return mesh;
}

/// A strip bent to and fro `folds` times.
TriangleMesh Accordion(int folds, double gap) {
  TriangleMesh mesh;
  for (int i = 0; i <= folds; ++i) {
    mesh.positions.emplace_back(i % 2, 0.0, gap * i);
    mesh.positions.emplace_back(i % 2, 1.0, gap * i);
    if (i == 0) continue;
    mesh.faces.emplace_back(2 * i - 2, 2 * i, 2 * i - 1);
    mesh.faces.emplace_back(2 * i - 1, 2 * i, 2 * i + 1);
  }
  return mesh;
}

/// A triangle whose longest side many small ones share with it, closed by faces without area: what
/// exporters leave of T-junctions.
TriangleMesh Junctions(int count) {
  TriangleMesh mesh;
  for (int i = 0; i <= count; ++i) {
    mesh.positions.emplace_back(static_cast<double>(i) / count, 0.0, 0.0);
  }
  const int below = count + 1;
  mesh.positions.emplace_back(0.5, -1.0, 0.0);
  mesh.positions.emplace_back(0.5, 1.0, 0.0);
  for (int i = 0; i < count; ++i) mesh.faces.emplace_back(i + 1, i, below);
  mesh.faces.emplace_back(0, count, below + 1);
  for (int i = 1; i < count; ++i) mesh.faces.emplace_back(0, i, i + 1);
  return mesh;
}

TriangleMesh Shape(int kind, Dice* dice) {
  const auto some = [&](int low, int high) { return static_cast<int>(dice->Integer(low, high)); };
  switch (kind) {
    case 0:
      return Strip(1.0, 1.0);
    case 1:
      return shapes::SingleTriangle();
    case 2:
      return shapes::PlaneGrid(1.0, 1.0, some(1, 12), some(1, 12));
    case 3:
      return Pierced(shapes::PlaneGrid(1.0, 1.0, some(3, 16), some(3, 16)), 0.2, dice);
    case 4:
      return shapes::Cube();
    case 5:
      return Pierced(shapes::Subdivided(shapes::Cube()), 0.15, dice);
    case 6:
      return shapes::Cylinder(1.0, 1.0, some(3, 30), some(1, 10));
    case 7:
      return shapes::Torus(1.0, 0.4, some(3, 24), some(3, 12));
    case 8:
      return shapes::SphereWithHole(dice->Uniform(0.2, 2.5), some(4, 12), some(4, 16));
    case 9:
      return shapes::PlateWithHoles(some(1, 3), some(0, 1));
    case 10:
      return shapes::Saddle(some(2, 12));
    case 11:
      return shapes::MoebiusStrip(some(3, 30), some(1, 4));
    case 12:
      return Fan(some(3, 200), dice->Uniform(0.0, 1.0));
    case 13:
      return Accordion(some(2, 60), dice->Decades(-4.0, 0.0));
    case 14:
      return Junctions(some(2, 60));
    case 15:
      return shapes::Unwelded(shapes::Icosphere(some(0, 2)));
    case 16:
      return shapes::ThreeFins();
    default:
      return shapes::Icosphere(some(0, 2));
  }
}
constexpr int kShapes = 18;

/// Up to four shapes, some of them far away or tiny.
TriangleMesh Pieces(std::string* name, Dice* dice) {
  std::vector<TriangleMesh> pieces;
  const std::int64_t count = dice->Chance(0.6) ? 1 : dice->Integer(2, 4);
  for (std::int64_t i = 0; i < count; ++i) {
    const auto kind = static_cast<int>(dice->Integer(0, kShapes - 1));
    absl::StrAppend(name, " ", kind);
    TriangleMesh piece = Shape(kind, dice);
    if (i > 0) {
      const Eigen::Vector3d offset(dice->Uniform(-3, 3), dice->Uniform(-3, 3), 3.0 * i);
      piece = shapes::Moved(std::move(piece), offset, dice->Decades(-3.0, 1.0));
    }
    pieces.push_back(std::move(piece));
  }
  return shapes::DisjointUnion(pieces);
}

void Stretch(std::string* name, Dice* dice, TriangleMesh* mesh) {
  const Eigen::Matrix3d before = dice->Rotation();
  const Eigen::Matrix3d after = dice->Rotation();
  Eigen::Vector3d factors;
  for (double& factor : factors) factor = dice->Decades(-kDecades, kDecades);
  // Also along the axes, where flat shapes stay exactly flat.
  const bool turned = dice->Chance(0.5);
  const double far = dice->Chance(0.2) ? dice->Decades(0.0, 5.0) * factors.maxCoeff() : 0.0;
  for (Eigen::Vector3d& p : mesh->positions) {
    p = factors.cwiseProduct(turned ? Eigen::Vector3d(before * p) : p);
    if (turned) p = after * p;
    p.array() += far;
  }
  absl::StrAppend(name, " stretched by ", factors[0], ", ", factors[1], ", ", factors[2]);
}

SamplingOptions Options(Dice* dice, TriangleMesh* mesh) {
  constexpr std::array<SamplingMethod, 5> kOthers = {
      SamplingMethod::kWhiteNoise, SamplingMethod::kPoissonDisk, SamplingMethod::kSampleElimination,
      SamplingMethod::kLloyd, SamplingMethod::kCcvt};
  SamplingOptions options;
  options.sample_count = dice->Integer(4, dice->Chance(0.3) ? 300 : 40);
  options.seed = static_cast<std::uint64_t>(dice->Integer(0, 1000));
  if (dice->Chance(0.4)) {
    options.method = kOthers[static_cast<std::size_t>(dice->Integer(0, 4))];
    options.max_iterations = 30;
  }
  if (dice->Chance(0.1)) options.energy = Energy::kSquaredArea;
  if (dice->Chance(0.4)) options.crease_angle = dice->Uniform(0.05, 3.1);
  if (dice->Chance(0.1)) options.weld_tolerance = dice->Decades(-kDecades, kDecades);
  if (dice->Chance(0.25)) {
    Attribute heat{.name = "heat"};
    for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
      heat.values.push_back(static_cast<float>(dice->Decades(-4.0, 4.0)));
    }
    mesh->attributes = {heat};
    options.density.source = DensitySource::kAttribute;
    options.density.attribute = "heat";
    options.density.max_contrast = dice->Decades(0.1, 6.0);
  } else if (dice->Chance(0.1)) {
    options.density.source = DensitySource::kCurvature;
  }
  return options;
}

}  // namespace

StretchedCase MakeStretchedCase(std::uint64_t number) {
  Dice dice(number);
  StretchedCase made;
  made.name = absl::StrCat("case ", number, ": shapes");
  made.mesh = Pieces(&made.name, &dice);
  Stretch(&made.name, &dice, &made.mesh);
  made.options = Options(&dice, &made.mesh);
  absl::StrAppend(&made.name, ", method ", static_cast<int>(made.options.method), ", ",
                  made.options.sample_count, " samples");
  return made;
}

TriangleMesh Strip(double length, double width) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {length, 0, 0}, {length, width, 0}, {0, width, 0}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh Pile(int sheets) {
  TriangleMesh mesh;
  for (int i = 0; i <= sheets; ++i) {
    mesh.positions.emplace_back(i % 2, 0.0, 1e-7 * i);
    mesh.positions.emplace_back(i % 2, 1.0, 1e-7 * i);
    if (i == 0) continue;
    mesh.faces.emplace_back(2 * i - 2, 2 * i, 2 * i - 1);
    mesh.faces.emplace_back(2 * i - 1, 2 * i, 2 * i + 1);
  }
  return mesh;
}

}  // namespace ccst::test
