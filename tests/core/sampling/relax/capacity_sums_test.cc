#include "core/sampling/relax/capacity_sums.h"

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/random/random.h"

namespace ccst::internal {
namespace {

// Triangles of random corners far from the origin, of two components, and the sums over some.
struct Subject {
  explicit Subject(std::int32_t count) {
    const CounterRandom random(1, 7);
    for (std::int32_t v = 0; v < 3 * count; ++v) {
      places.push_back({0.4 + 1e-3 * random.Uniform(3 * v), -0.3 + 1e-3 * random.Uniform(3 * v + 1),
                        0.2 + 1e-3 * random.Uniform(3 * v + 2), 0.0});
      origins.push_back(v);
      components.push_back(v / 3 % 2);
    }
    for (std::int32_t t = 0; t < count; ++t) {
      densities.push_back(static_cast<float>(0.5 + random.Uniform(9 * count + t)));
    }
  }

  CapacitySources Sources(bool uniform) const {
    return {.places = places.data(),
            .origins = origins.data(),
            .components = components.data(),
            .scales = scales.data(),
            .densities = uniform ? nullptr : densities.data()};
  }

  CapacitySums SumByHand(bool uniform, std::int32_t first, std::int32_t end) const {
    CapacitySums sums;
    for (std::int32_t t = first; t < end; ++t) {
      const auto at = [&](int k) { return Eigen::Vector3d::Map(&places[3 * t + k].x); };
      const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
      const double apart = area * scales[t % 2] * (uniform ? 1.0 : densities[t]) - 1.0;
      sums.apart += apart;
      sums.square += apart * apart;
    }
    return sums;
  }

  std::vector<RingPlace> places;
  std::vector<std::int32_t> origins;
  std::vector<std::int32_t> components;
  std::vector<double> scales = {4e6, 7e6};
  std::vector<float> densities;
};

TEST(CapacitySums, AgreeWithDoublePrecision) {
  const Subject subject(2000);
  for (const bool uniform : {true, false}) {
    for (const std::int32_t end : {1, 7, 8, 9, 255, 256, 257, 2000}) {
      const CapacitySums sums =
          SumCapacities(subject.Sources(uniform), Registers::kPortable, 0, end);
      const CapacitySums expected = subject.SumByHand(uniform, 0, end);
      EXPECT_NEAR(sums.apart, expected.apart, 3e-6 * end) << end;
      EXPECT_NEAR(sums.square, expected.square, 3e-6 * expected.square) << end;
    }
  }
}

TEST(CapacitySums, PartsAddUp) {
  const Subject subject(2000);
  const CapacitySources sources = subject.Sources(true);
  const CapacitySums one = SumCapacities(sources, Registers::kPortable, 0, 777);
  const CapacitySums rest = SumCapacities(sources, Registers::kPortable, 777, 2000);
  const CapacitySums all = SumCapacities(sources, Registers::kPortable, 0, 2000);
  EXPECT_NEAR(one.square + rest.square, all.square, 1e-6 * all.square);
}

TEST(CapacitySums, WidestRegistersGiveTheSameBits) {
  const Subject subject(1003);
  for (const bool uniform : {true, false}) {
    const CapacitySums any = SumCapacities(subject.Sources(uniform), Registers::kPortable, 0, 1003);
    const CapacitySums widest = SumCapacities(subject.Sources(uniform), WidestRegisters(), 0, 1003);
    EXPECT_EQ(any.apart, widest.apart);
    EXPECT_EQ(any.square, widest.square);
  }
}

}  // namespace
}  // namespace ccst::internal
