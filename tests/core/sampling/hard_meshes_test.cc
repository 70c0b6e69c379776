// Meshes on which something takes long: whatever it is, the time limit ends it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/sampling/sampling.h"
#include "tests/support/memory_meter.h"
#include "tests/support/shapes.h"
#include "tests/support/stretched.h"

namespace ccst {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::int64_t kMostForCcvt = 20'000;
constexpr std::int64_t kMostBytes = std::int64_t{1} << 30;

/// A square whose lower side meets `count` faces, each over a vertex that lies on the side and is
/// no corner of the square's face; faces without area join them, as exporters write it.
TriangleMesh TJunctions(int count) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  std::int32_t last = 0;
  for (int i = 1; i <= count; ++i) {
    const double x = static_cast<double>(i) / count;
    const auto low = static_cast<std::int32_t>(mesh.positions.size());
    mesh.positions.emplace_back(x - 0.5 / count, -1.0 / count, 0.0);
    std::int32_t next = 1;
    if (i < count) {
      next = low + 1;
      mesh.positions.emplace_back(x, 0.0, 0.0);
      mesh.faces.emplace_back(last, next, 1);  // Without area.
    }
    mesh.faces.emplace_back(last, low, next);
    last = next;
  }
  return mesh;
}

/// A disk of `count` faces around one vertex.
TriangleMesh Hub(int count) {
  TriangleMesh mesh;
  mesh.positions.emplace_back(0, 0, 0);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.3 * std::cos(40.0 * angle));
  }
  for (int i = 0; i < count; ++i) mesh.faces.emplace_back(0, 1 + i, 1 + (i + 1) % count);
  return mesh;
}

/// The same, closed by another vertex.
TriangleMesh Bipyramid(int count) {
  TriangleMesh mesh = Hub(count);
  mesh.positions.emplace_back(0, 0, 1);
  const auto top = static_cast<std::int32_t>(mesh.positions.size()) - 1;
  for (int i = 0; i < count; ++i) mesh.faces.emplace_back(top, 1 + (i + 1) % count, 1 + i);
  return mesh;
}

/// `count` faces at one edge.
TriangleMesh Book(int count) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0.5);
    mesh.faces.emplace_back(i % 2, 1 - i % 2, 2 + i);
  }
  return mesh;
}

TriangleMesh Tetrahedra(int count) {
  TriangleMesh mesh;
  const TriangleMesh one = shapes::Tetrahedron();
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::int32_t>(mesh.positions.size());
    for (const Eigen::Vector3d& p : one.positions) {
      mesh.positions.emplace_back(p + Eigen::Vector3d(4 * (i % 300), 4 * (i / 300), 0));
    }
    for (const Eigen::Vector3i& f : one.faces)
      mesh.faces.emplace_back(f + Eigen::Vector3i::Constant(first));
  }
  return mesh;
}

/// A grid with a bump at every vertex, and with `holes` one face of every eight missing.
TriangleMesh Rough(int cells, bool holes) {
  const TriangleMesh grid = shapes::PlaneGrid(1.0, 1.0, cells, cells);
  TriangleMesh mesh;
  mesh.positions = grid.positions;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i].z() += static_cast<double>(i * 2654435761U % 1000) / 1000.0 / cells;
  }
  for (std::size_t f = 0; f < grid.faces.size(); ++f) {
    if (!holes || f % 8 != 3) mesh.faces.push_back(grid.faces[f]);
  }
  return mesh;
}

/// Faces a thousand times `columns` times as long as wide.
TriangleMesh Needles(int columns) { return shapes::PlaneGrid(1.0, 1000.0, columns, 1); }

struct HardCase {
  std::string name;
  std::function<TriangleMesh()> make;
  std::function<void(SamplingOptions&)> ask = [](SamplingOptions&) {};
};

double CpuSeconds() {
  timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<HardCase> HardCases(int size) {
  const auto crease = [](double angle) {
    return [angle](SamplingOptions& options) { options.crease_angle = angle; };
  };
  const auto density = [](SamplingOptions& options) {
    options.density.source = DensitySource::kCurvature;
    options.density.max_contrast = 1e6;
  };
  const auto weld = [](double tolerance) {
    return [tolerance](SamplingOptions& options) { options.weld_tolerance = tolerance; };
  };
  const int cells = static_cast<int>(std::sqrt(size));
  return {{"T-junctions", [=] { return TJunctions(size); }},
          {"a hub", [=] { return Hub(size); }},
          {"a hub with creases", [=] { return Hub(size); }, crease(1e-6)},
          {"two hubs", [=] { return Bipyramid(size); }},
          {"two hubs by curvature", [=] { return Bipyramid(size); }, density},
          {"a book", [=] { return Book(size); }},
          {"a pile", [=] { return test::Pile(size); }},
          {"tetrahedra", [=] { return Tetrahedra(size / 4); }},
          {"a rough grid", [=] { return Rough(cells, false); }},
          {"a rough grid with creases", [=] { return Rough(cells, false); }, crease(1e-3)},
          {"a rough grid by curvature", [=] { return Rough(cells, false); }, density},
          {"a rough grid with holes", [=] { return Rough(cells, true); }},
          {"a soup", [=] { return shapes::Unwelded(Rough(cells, false)); }, weld(0.01 / cells)},
          {"a clump", [=] { return shapes::Unwelded(Rough(cells, false)); }, weld(0.5)},
          {"needles", [=] { return Needles(size); }},
          {"needles with creases",
           [=] {
             TriangleMesh mesh = Needles(size);
             for (std::size_t i = 0; i < mesh.positions.size(); ++i)
               mesh.positions[i].z() = 1e-3 * (i % 2);
             return mesh;
           },
           crease(1e-3)},
          {"a Moebius strip", [=] { return shapes::MoebiusStrip(cells, cells); }}};
}

constexpr std::array kAllMethods = {
    SamplingMethod::kCcst,  SamplingMethod::kWhiteNoise,        SamplingMethod::kPoissonDisk,
    SamplingMethod::kLloyd, SamplingMethod::kSampleElimination, SamplingMethod::kCcvt};

// Time of this thread alone, so that others on the machine do not count.
void ExpectLimitsHold(int size, std::int64_t count, const std::vector<double>& limits) {
  constexpr double kSlack = 0.5;  // [s]
  for (const HardCase& hard : HardCases(size)) {
    const TriangleMesh mesh = hard.make();
    for (const SamplingMethod method : kAllMethods) {
      for (const double limit : limits) {
        SamplingOptions options;
        options.sample_count =
            method == SamplingMethod::kCcvt ? std::min(count, kMostForCcvt) : count;
        options.method = method;
        options.time_limit_seconds = limit;
        hard.ask(options);
        const test::MemoryMeter meter(kMostBytes);
        const double start = CpuSeconds();
        const absl::StatusOr<SamplingResult> result = SampleSurface(mesh, options);
        const double seconds = CpuSeconds() - start;
        SCOPED_TRACE(absl::StrCat(hard.name, ", method ", static_cast<int>(method), ", limit ",
                                  limit, " s: ", result.status().ToString()));
        EXPECT_LE(seconds, limit + kSlack);
        if (result.ok()) {
          EXPECT_EQ(result->samples.positions.size(), options.sample_count);
        } else {
          EXPECT_TRUE(GetErrorReason(result.status()) == ErrorReason::kTimeLimitExceeded ||
                      GetErrorReason(result.status()) == ErrorReason::kCountTooSmall);
        }
      }
    }
  }
}

TEST(HardMeshes, TimeLimitHoldsForEveryMethod) { ExpectLimitsHold(20'000, 10'000, {0.1}); }

// Minutes: the long tests run it.
TEST(HardMeshes, DISABLED_TimeLimitHoldsForEveryMethodAtLength) {
  ExpectLimitsHold(300'000, 200'000, {0.1, 1.0, 5.0});
}

}  // namespace
}  // namespace ccst
