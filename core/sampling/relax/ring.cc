#include "core/sampling/relax/ring.h"

#include <algorithm>
#include <cmath>

#include "core/sampling/relax/lanes.h"
#include "core/sampling/relax/triangle_lanes.h"

namespace ccst::internal {

static_assert(Ring::kLanes == kLanes);

namespace {

/// The mask of k triangles begins k before its middle.
constexpr std::int32_t kLive[2 * kLanes] = {-1, -1, -1, -1, -1, -1, -1, -1};

/// The last seven and then the first of `after`.
CCST_INLINE Lanes Shifted(const Lanes& a, const Lanes& after) {
  return __builtin_shufflevector(a, after, 1, 2, 3, 4, 5, 6, 7, 8);
}

/// The last seven of eight and then `row`.
CCST_INLINE Lanes3 Shifted(const Lanes3& a, const Row& row) {
  return {__builtin_shufflevector(a.x, Pair(row, row), 1, 2, 3, 4, 5, 6, 7, 8),
          __builtin_shufflevector(a.y, Pair(row, row), 1, 2, 3, 4, 5, 6, 7, 9),
          __builtin_shufflevector(a.z, Pair(row, row), 1, 2, 3, 4, 5, 6, 7, 10)};
}

CCST_INLINE float Total(const Lanes& a) {
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

/// The totals of eight, in their order, summed up in the order that Total() has.
CCST_INLINE Lanes Totals(const Lanes (&a)[8]) {
  const auto halves = [](const Lanes& x, const Lanes& y) {
    return __builtin_shufflevector(x, y, 0, 1, 2, 3, 8, 9, 10, 11) +
           __builtin_shufflevector(x, y, 4, 5, 6, 7, 12, 13, 14, 15);
  };
  const auto quarters = [](const Lanes& x, const Lanes& y) {
    return __builtin_shufflevector(x, y, 0, 1, 8, 9, 4, 5, 12, 13) +
           __builtin_shufflevector(x, y, 2, 3, 10, 11, 6, 7, 14, 15);
  };
  const auto eighths = [](const Lanes& x, const Lanes& y) {
    return __builtin_shufflevector(x, y, 0, 2, 8, 10, 4, 6, 12, 14) +
           __builtin_shufflevector(x, y, 1, 3, 9, 11, 5, 7, 13, 15);
  };
  return eighths(quarters(halves(a[0], a[4]), halves(a[1], a[5])),
                 quarters(halves(a[2], a[6]), halves(a[3], a[7])));
}

/// Of the triangles that face the surface less than they should the least square of the cosine
/// with its sign, -1 for one without extent; 2 when all face it.
CCST_INLINE float LeastFacing(const Ring::Block& block, const Triangles& t, const Vector3& n) {
  const Facing facing = FacingOf(t, Load(block.up) + n);
  const Choice bad = ~facing.enough & LoadAs<Choice>(block.live);
  float least = 2.0F;
  if (!Any(bad)) return least;
  for (int k = 0; k < kLanes; ++k) {
    if (bad[k] == 0) continue;
    const float dot = facing.dot[k];
    least = std::min(least, facing.scale[k] > 0.0F ? dot * std::abs(dot) / facing.scale[k] : -1.0F);
  }
  return least;
}

CCST_INLINE void FinishIn(const RingPlace* places, const RingNormal* normals, std::int32_t vertex,
                          Ring* ring) {
  const int neighbours = ring->neighbours;
  ring->triangles = ring->closed ? neighbours : neighbours - 1;
  const int end = kLanes * ring->block_count();
  // A closed ring goes round again; an open one stays where it ends.
  std::int32_t* u = ring->vertex.data();
  for (int i = neighbours; i <= end; ++i) u[i] = u[ring->closed ? i - neighbours : neighbours - 1];
  const LongRow base = LoadAs<LongRow>(&places[vertex]);
  const auto place = [&](int i) {
    return __builtin_convertvector(LoadAs<LongRow>(&places[u[i]]) - base, Row);
  };
  for (int i = 0; i < end; i += kLanes) {
    Ring::Block& block = ring->blocks[i / kLanes];
    Row rows[kLanes];
    for (int k = 0; k < kLanes; ++k) rows[k] = place(i + k);
    const Lanes3 p = Transposed(rows);
    Store(p, block.p);
    Store(Shifted(p, place(i + kLanes)), block.q);
    for (int k = 0; k < kLanes; ++k) rows[k] = LoadAs<Row>(&normals[u[i + k]]);
    const Lanes3 up = Transposed(rows);
    Store(up + Shifted(up, LoadAs<Row>(&normals[u[i + kLanes]])), block.up);
    const auto live = LoadAs<Choice>(kLive + kLanes - std::min(ring->triangles - i, kLanes));
    std::memcpy(block.live, &live, sizeof live);
    Store(Masked(live, ring->uniform ? All(1.0F) : Load(&ring->density[i])), block.density);
  }
}

CCST_INLINE void StoreAngles(const Triangles& t, int first, RingAngles* angles) {
  Store(t.length, &angles->length[first]);
  Store(t.AtP(), &angles->at_p[first]);
  Store(t.AtQ(), &angles->at_q[first]);
}

CCST_INLINE RingSums SumIn(const Ring& ring, Energy energy, const Vector3& n, const Vector3& t1,
                           const Vector3& t2) {
  LaneSums lanes;
  const auto scale = static_cast<float>(ring.scale);
  float least_facing = 1.0F;
  for (int b = 0; b < ring.block_count(); ++b) {
    const Ring::Block& block = ring.blocks[b];
    const Triangles t = TrianglesOf(Load(block.p), Load(block.q));
    lanes.Add(t, Load(block.density), scale, energy, LoadAs<Choice>(block.live), t1, t2);
    least_facing = std::min(least_facing, LeastFacing(block, t, n));
  }
  const Lanes found = Totals({lanes.energy, lanes.area, lanes.gradient.x, lanes.gradient.y,
                              lanes.gradient.z, lanes.h11, lanes.h12, lanes.h22});
  RingSums sums;
  sums.energy = found[0];
  sums.area = found[1];
  sums.gradient = {found[2], found[3], found[4]};
  sums.h11 = found[5];
  sums.h12 = found[6];
  sums.h22 = found[7];
  sums.least_facing = least_facing;
  return sums;
}

CCST_INLINE bool EvaluateIn(const Ring& ring, Energy energy, const Vector3& step, const Vector3& n,
                            float least_facing, double* sum, RingAngles* angles) {
  Lanes total = {};
  const auto scale = static_cast<float>(ring.scale);
  for (int b = 0; b < ring.block_count(); ++b) {
    const Ring::Block& block = ring.blocks[b];
    const Triangles t = TrianglesOf(Load(block.p) - step, Load(block.q) - step);
    if (LeastFacing(block, t, n) <= least_facing) return false;
    StoreAngles(t, kLanes * b, angles);
    total += EnergyOf(scale * Load(block.density) * t.length, energy, LoadAs<Choice>(block.live));
  }
  *sum = Total(total);
  return true;
}

CCST_INLINE void MeasureAnglesIn(const Ring& ring, RingAngles* angles) {
  for (int b = 0; b < ring.block_count(); ++b) {
    const Ring::Block& block = ring.blocks[b];
    StoreAngles(TrianglesOf(Load(block.p), Load(block.q)), kLanes * b, angles);
  }
}

CCST_INLINE int FindSpoiltIn(const Ring& ring, const RingAngles& angles,
                             std::array<int, Ring::kMost>* spokes) {
  // Between each triangle and the next: all around a closed ring, on the boundary one less.
  const int count = ring.closed ? ring.triangles : ring.triangles - 1;
  int found = 0;
  bool is_first_spoilt = false;
  for (int i = 0; i < count; i += kLanes) {
    const int after = i + kLanes < ring.triangles ? i + kLanes : 0;
    const Lanes length = Load(&angles.length[i]);
    const Lanes at_q = Shifted(Load(&angles.at_q[i]), Load(&angles.at_q[after]));
    const Lanes next_length = Shifted(length, Load(&angles.length[after]));
    const Choice spoilt = length * at_q + Load(&angles.at_p[i]) * next_length < 0.0F;
    if (!Any(spoilt)) continue;
    for (int k = i; k < std::min(i + kLanes, count); ++k) {
      if (spoilt[k - i] == 0) continue;
      if (k + 1 == ring.neighbours) {
        is_first_spoilt = true;
      } else {
        (*spokes)[found++] = k + 1;
      }
    }
  }
  if (is_first_spoilt) {
    std::copy_backward(spokes->begin(), spokes->begin() + found, spokes->begin() + found + 1);
    (*spokes)[0] = 0;
    ++found;
  }
  return found;
}

CCST_AVX2 void FinishWide(const RingPlace* places, const RingNormal* normals, std::int32_t vertex,
                          Ring* ring) {
  FinishIn(places, normals, vertex, ring);
}

CCST_AVX2 RingSums SumWide(const Ring& ring, Energy energy, const Vector3& n, const Vector3& t1,
                           const Vector3& t2) {
  return SumIn(ring, energy, n, t1, t2);
}

CCST_AVX2 bool EvaluateWide(const Ring& ring, Energy energy, const Vector3& step, const Vector3& n,
                            float least_facing, double* sum, RingAngles* angles) {
  return EvaluateIn(ring, energy, step, n, least_facing, sum, angles);
}

CCST_AVX2 void MeasureAnglesWide(const Ring& ring, RingAngles* angles) {
  MeasureAnglesIn(ring, angles);
}

CCST_AVX2 int FindSpoiltWide(const Ring& ring, const RingAngles& angles,
                             std::array<int, Ring::kMost>* spokes) {
  return FindSpoiltIn(ring, angles, spokes);
}

}  // namespace

Registers WidestRegisters() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) return Registers::kAvx2;
#endif
  return Registers::kPortable;
}

void Finish(const RingPlace* places, const RingNormal* normals, std::int32_t vertex,
            Registers registers, Ring* ring) {
  if (registers == Registers::kAvx2) return FinishWide(places, normals, vertex, ring);
  FinishIn(places, normals, vertex, ring);
}

RingSums Sum(const Ring& ring, Energy energy, const Eigen::Vector3d& n, const Eigen::Vector3d& t1,
             const Eigen::Vector3d& t2, Registers registers) {
  if (registers == Registers::kAvx2) {
    return SumWide(ring, energy, Vector3(n), Vector3(t1), Vector3(t2));
  }
  return SumIn(ring, energy, Vector3(n), Vector3(t1), Vector3(t2));
}

bool Evaluate(const Ring& ring, Energy energy, const Eigen::Vector3d& step,
              const Eigen::Vector3d& n, double least_facing, Registers registers, double* sum,
              RingAngles* angles) {
  const auto least = static_cast<float>(least_facing);
  if (registers == Registers::kAvx2) {
    return EvaluateWide(ring, energy, Vector3(step), Vector3(n), least, sum, angles);
  }
  return EvaluateIn(ring, energy, Vector3(step), Vector3(n), least, sum, angles);
}

void MeasureAngles(const Ring& ring, Registers registers, RingAngles* angles) {
  if (registers == Registers::kAvx2) return MeasureAnglesWide(ring, angles);
  MeasureAnglesIn(ring, angles);
}

int FindSpoilt(const Ring& ring, const RingAngles& angles, Registers registers,
               std::array<int, Ring::kMost>* spokes) {
  if (registers == Registers::kAvx2) return FindSpoiltWide(ring, angles, spokes);
  return FindSpoiltIn(ring, angles, spokes);
}

}  // namespace ccst::internal
