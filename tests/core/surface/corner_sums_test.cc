#include "core/surface/corner_sums.h"

#include <cmath>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst {
namespace {

// Numbers whose sum depends on the order of adding.
double Value(std::int64_t face, int corner) {
  return std::ldexp(1.0 / static_cast<double>(3 + face), 7 * corner);
}

std::vector<double> Sums(const TriangleMesh& mesh, const Parallel& parallel, Interrupt* interrupt) {
  std::vector<double> sums(mesh.positions.size(), 0.0);
  CornerSums(mesh.faces, static_cast<std::int32_t>(mesh.positions.size()))
      .Add(
          parallel, interrupt,
          [](std::int64_t f, const auto& add) {
            for (int k = 0; k < 3; ++k) add(k, Value(f, k));
          },
          &sums);
  return sums;
}

TEST(CornerSums, AddInTheOrderOfFaces) {
  const TriangleMesh mesh = shapes::Torus(1, 0.35, 200, 100);
  std::vector<double> expected(mesh.positions.size(), 0.0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      expected[mesh.faces[f][k]] += Value(static_cast<std::int64_t>(f), k);
    }
  }
  Interrupt never;
  for (const int threads : {1, 2, 3, 8}) {
    EXPECT_EQ(Sums(mesh, Parallel(threads), &never), expected) << threads << " threads";
  }
}

TEST(CornerSums, EndWhenStopped) {
  std::stop_source stop;
  stop.request_stop();
  Interrupt interrupt(stop.get_token());
  const TriangleMesh mesh = shapes::Icosphere(2);
  EXPECT_EQ(Sums(mesh, Parallel(), &interrupt), std::vector<double>(mesh.positions.size(), 0.0));
}

}  // namespace
}  // namespace ccst
