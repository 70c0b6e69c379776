#include "core/sampling/relax/ring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/random/random.h"

namespace ccst::internal {
namespace {

const Eigen::Vector3d kFar(1000, -3000, 2000);
const Eigen::Vector3d kUp(0, 0, 1);
const Eigen::Vector3d kT1(1, 0, 0);
const Eigen::Vector3d kT2(0, 1, 0);

/// What single precision may be wrong by, relative to the ring's width.
constexpr double kRounding = 3e-6;

/// A ring of width 1 around `s`, uneven and not quite flat, of samples numbered backwards, far from
/// the origin.
struct RingFixture {
  RingFixture(int neighbours, bool closed, bool uniform = true,
              Registers registers = WidestRegisters(),
              const Eigen::Vector3d& s = {0.02, -0.03, 0.01})
      : ring(std::make_unique<Ring>()), vertex(s) {
    const CounterRandom random(7, static_cast<std::uint64_t>(neighbours));
    std::uint64_t next = 0;
    const auto any = [&](double low, double high) {
      return low + (high - low) * random.Uniform(next++);
    };
    places.resize(neighbours + 1);
    normals.resize(neighbours + 1);
    const Eigen::Vector3d at = kFar + s;
    places[neighbours] = {at[0], at[1], at[2], 0.0};
    ring->uniform = uniform;
    ring->closed = closed;
    ring->density.fill(std::numeric_limits<float>::quiet_NaN());  // Whatever was there before.
    ring->scale = 0.15 * neighbours;                              // No capacity is near nothing.
    for (int i = 0; i < neighbours; ++i) {
      const double turn = closed ? 2.0 * std::numbers::pi : 0.8 * std::numbers::pi;
      const double angle = turn * (i + any(-0.2, 0.2)) / neighbours;
      const double radius = any(0.8, 1.3);
      const int v = neighbours - 1 - i;
      const Eigen::Vector3d place =
          kFar +
          Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), any(-0.1, 0.1));
      places[v] = {place[0], place[1], place[2], 0.0};
      normals[v] = {0.0F, 0.125F, 1.0F, 0.0F};
      ring->vertex[i] = v;
      if (!uniform) ring->density[i] = static_cast<float>(any(0.5, 2.0));
    }
    ring->neighbours = neighbours;
    std::copy_n(ring->density.begin(), neighbours, std::back_inserter(density));
    Finish(places.data(), normals.data(), neighbours, registers, ring.get());
  }

  Eigen::Vector3d Position(int i) const {
    const RingPlace& place = places[ring->vertex[i % ring->neighbours]];
    return Eigen::Vector3d(place.x, place.y, place.z) - kFar;
  }

  /// The energy around `s`, by its definition.
  double EnergyAt(const Eigen::Vector3d& s, Energy energy) const {
    double sum = 0.0;
    for (int i = 0; i < ring->triangles; ++i) {
      const double rho = ring->uniform ? 1.0 : density[i];
      const double c = ring->scale * rho * (Position(i) - s).cross(Position(i + 1) - s).norm();
      sum += energy == Energy::kTarget ? (c - 1.0) * (c - 1.0) : c * c;
    }
    return sum;
  }

  std::vector<RingPlace> places;
  std::vector<RingNormal> normals;
  std::vector<double> density;
  std::unique_ptr<Ring> ring;
  Eigen::Vector3d vertex;
};

class AnyRing : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Valences, AnyRing, testing::Values(3, 4, 5, 6, 7, 8, 9, 12, 13, 95));

TEST_P(AnyRing, SumAgreesWithItsDefinition) {
  for (const bool closed : {true, false}) {
    for (const bool uniform : {true, false}) {
      const RingFixture fixture(GetParam(), closed, uniform);
      EXPECT_EQ(fixture.ring->triangles, closed ? GetParam() : GetParam() - 1);
      double area = 0.0;
      for (int i = 0; i < fixture.ring->triangles; ++i) {
        area += (fixture.Position(i) - fixture.vertex)
                    .cross(fixture.Position(i + 1) - fixture.vertex)
                    .norm();
      }
      for (const Energy energy : {Energy::kTarget, Energy::kSquaredArea}) {
        const RingSums sums = Sum(*fixture.ring, energy, kUp, kT1, kT2, WidestRegisters());
        const double expected = fixture.EnergyAt(fixture.vertex, energy);
        EXPECT_NEAR(sums.energy, expected, kRounding * expected);
        EXPECT_NEAR(sums.area, area, kRounding * area);
      }
    }
  }
}

TEST_P(AnyRing, GradientAgreesWithDifferences) {
  constexpr double kStep = 1e-6;
  for (const Energy energy : {Energy::kTarget, Energy::kSquaredArea}) {
    const RingFixture fixture(GetParam(), true, false);
    const RingSums sums = Sum(*fixture.ring, energy, kUp, kT1, kT2, WidestRegisters());
    const double scale = fixture.ring->scale;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const double slope = (fixture.EnergyAt(fixture.vertex + step, energy) -
                            fixture.EnergyAt(fixture.vertex - step, energy)) /
                           (2 * kStep);
      EXPECT_NEAR(2.0 * scale * scale * sums.gradient[k], slope, 1e-5 * (1.0 + std::abs(slope)));
    }
  }
}

TEST_P(AnyRing, MajoriserIsTheHessianOfSquaredAreas) {
  constexpr double kStep = 1e-3;
  const RingFixture fixture(GetParam(), true, false);
  const RingSums sums = Sum(*fixture.ring, Energy::kSquaredArea, kUp, kT1, kT2, WidestRegisters());
  const auto at = [&](double u, double w) {
    return fixture.EnergyAt(fixture.vertex + u * kStep * kT1 + w * kStep * kT2,
                            Energy::kSquaredArea);
  };
  // Squared areas are quadratic: second differences are exact.
  const double unit = 2.0 * fixture.ring->scale * fixture.ring->scale * kStep * kStep;
  const double h11 = (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / unit;
  const double h22 = (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / unit;
  const double h12 = (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4.0 * unit);
  EXPECT_NEAR(sums.h11, h11, 1e-5 * sums.h11);
  EXPECT_NEAR(sums.h22, h22, 1e-5 * sums.h22);
  EXPECT_NEAR(sums.h12, h12, 1e-5 * sums.h11);
}

TEST_P(AnyRing, EvaluateGivesTheEnergyOfThePlace) {
  const RingFixture fixture(GetParam(), true, false);
  const Eigen::Vector3d step(-0.05, 0.04, 0.0);
  RingAngles angles;
  double energy = 0.0;
  ASSERT_TRUE(Evaluate(*fixture.ring, Energy::kTarget, step, kUp, 1.0, WidestRegisters(), &energy,
                       &angles));
  const double expected = fixture.EnergyAt(fixture.vertex + step, Energy::kTarget);
  EXPECT_NEAR(energy, expected, kRounding * expected);
}

TEST_P(AnyRing, EvaluateRefusesToTurnATriangleOver) {
  const RingFixture fixture(GetParam(), true);
  RingAngles angles;
  double energy = 0.0;
  EXPECT_FALSE(Evaluate(*fixture.ring, Energy::kTarget, {3.0, 0.0, 0.0}, kUp, 1.0,
                        WidestRegisters(), &energy, &angles));
  // Nor would anything do that faces the other way already.
  EXPECT_FALSE(Evaluate(*fixture.ring, Energy::kTarget, {0.0, 0.0, 0.0}, -9.0 * kUp, 1.0,
                        WidestRegisters(), &energy, &angles));
}

TEST_P(AnyRing, SpoiltEdgesAreThoseWithWideAnglesOpposite) {
  for (const bool closed : {true, false}) {
    const Eigen::Vector3d s(0.35, 0.25, 0.0);  // Near one side: some are spoilt.
    const RingFixture fixture(GetParam(), closed, true, WidestRegisters(), s);
    RingAngles angles;
    MeasureAngles(*fixture.ring, WidestRegisters(), &angles);
    std::array<int, Ring::kMost> spokes;
    const int count = FindSpoilt(*fixture.ring, angles, WidestRegisters(), &spokes);
    std::vector<int> expected;
    const int n = GetParam();
    for (int i = closed ? 0 : 1; i < (closed ? n : n - 1); ++i) {
      const auto angle = [&](const Eigen::Vector3d& at) {
        const Eigen::Vector3d a = s - at;
        const Eigen::Vector3d b = fixture.Position(i) - at;
        return std::atan2(a.cross(b).norm(), a.dot(b));
      };
      if (angle(fixture.Position(i + n - 1)) + angle(fixture.Position(i + 1)) > std::numbers::pi) {
        expected.push_back(i);
      }
    }
    EXPECT_EQ(std::vector<int>(spokes.begin(), spokes.begin() + count), expected);
  }
}

TEST_P(AnyRing, WideRegistersGiveTheSameBits) {
  if (WidestRegisters() == Registers::kPortable) GTEST_SKIP() << "this processor has no others";
  const Eigen::Vector3d step(0.1, -0.2, 0.03);
  RingSums sums[2];
  double energy[2] = {};
  RingAngles angles[2];
  std::array<int, Ring::kMost> spokes[2];
  int spoilt[2] = {};
  const Registers registers[2] = {Registers::kPortable, Registers::kAvx2};
  for (int k = 0; k < 2; ++k) {
    const RingFixture fixture(GetParam(), true, false, registers[k]);
    sums[k] = Sum(*fixture.ring, Energy::kTarget, kUp, kT1, kT2, registers[k]);
    ASSERT_TRUE(Evaluate(*fixture.ring, Energy::kTarget, step, kUp, -2.0, registers[k], &energy[k],
                         &angles[k]));
    spoilt[k] = FindSpoilt(*fixture.ring, angles[k], registers[k], &spokes[k]);
  }
  ASSERT_EQ(spoilt[0], spoilt[1]);
  EXPECT_TRUE(std::equal(spokes[0].begin(), spokes[0].begin() + spoilt[0], spokes[1].begin()));
  EXPECT_EQ(sums[0].energy, sums[1].energy);
  EXPECT_EQ(sums[0].area, sums[1].area);
  EXPECT_EQ(sums[0].gradient, sums[1].gradient);
  EXPECT_EQ(sums[0].h11, sums[1].h11);
  EXPECT_EQ(sums[0].h12, sums[1].h12);
  EXPECT_EQ(sums[0].h22, sums[1].h22);
  EXPECT_EQ(energy[0], energy[1]);
  for (int i = 0; i < GetParam(); ++i) {
    EXPECT_EQ(angles[0].length[i], angles[1].length[i]);
    EXPECT_EQ(angles[0].at_p[i], angles[1].at_p[i]);
    EXPECT_EQ(angles[0].at_q[i], angles[1].at_q[i]);
  }
}

}  // namespace
}  // namespace ccst::internal
