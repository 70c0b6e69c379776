#include "core/sampling/ring.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ccst {

namespace {

/// Least cosine between a triangle and the surface after a move, unless it was worse before.
constexpr double kLeastFacing = 0.2;
/// Bounds a triangle's capacity away from zero in the majoriser's gradient.
constexpr double kLeastCapacity = 0.05;

// Four doubles and the comparisons of four, in whatever registers the function is compiled for.
using Lanes = double __attribute__((vector_size(32)));
using Choice = std::int64_t __attribute__((vector_size(32)));

/// By the number of triangles in a block.
constexpr double kLive[5][4] = {
    {0, 0, 0, 0}, {1, 0, 0, 0}, {1, 1, 0, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}};

#define CCST_INLINE [[gnu::always_inline]] inline

struct Lanes3 {
  Lanes x, y, z;
};

CCST_INLINE Lanes Load(const double* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

CCST_INLINE Lanes3 Load(const double (&from)[3][4]) {
  return {Load(from[0]), Load(from[1]), Load(from[2])};
}

CCST_INLINE void Store(const Lanes& lanes, double (&to)[4]) {
  std::memcpy(to, &lanes, sizeof lanes);
}

CCST_INLINE void Store(const Lanes3& lanes, double (&to)[3][4]) {
  Store(lanes.x, to[0]);
  Store(lanes.y, to[1]);
  Store(lanes.z, to[2]);
}

/// Coordinates and one unused, of one sample.
CCST_INLINE Lanes Row(const RingPlace& place) {
  Lanes row;
  std::memcpy(&row, &place, sizeof row);
  return row;
}

CCST_INLINE Lanes Row(const RingNormal& normal) {
  float __attribute__((vector_size(16))) row;
  std::memcpy(&row, &normal, sizeof row);
  return __builtin_convertvector(row, Lanes);
}

/// Four rows as an array per coordinate.
CCST_INLINE Lanes3 Transposed(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d) {
  const Lanes xz_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Lanes xz_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Lanes y_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes y_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return {__builtin_shufflevector(xz_ab, xz_cd, 0, 1, 4, 5),
          __builtin_shufflevector(y_ab, y_cd, 0, 1, 4, 5),
          __builtin_shufflevector(xz_ab, xz_cd, 2, 3, 6, 7)};
}

/// The last three of four and then `row`.
CCST_INLINE Lanes3 Shifted(const Lanes3& a, const Lanes& row) {
  return {__builtin_shufflevector(a.x, row, 1, 2, 3, 4),
          __builtin_shufflevector(a.y, row, 1, 2, 3, 5),
          __builtin_shufflevector(a.z, row, 1, 2, 3, 6)};
}

CCST_INLINE Lanes3 Plus(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

CCST_INLINE Lanes3 Minus(const Lanes3& a, const Eigen::Vector3d& b) {
  return {a.x - b[0], a.y - b[1], a.z - b[2]};
}

CCST_INLINE Lanes3 Minus(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

CCST_INLINE Lanes Dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

CCST_INLINE Lanes Dot(const Lanes3& a, const Eigen::Vector3d& b) {
  return a.x * b[0] + a.y * b[1] + a.z * b[2];
}

CCST_INLINE Lanes3 Cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

CCST_INLINE Lanes Sqrt(const Lanes& a) {
  Lanes root;
  for (int k = 0; k < 4; ++k) root[k] = std::sqrt(a[k]);
  return root;
}

CCST_INLINE double Total(const Lanes& a) { return (a[0] + a[1]) + (a[2] + a[3]); }

CCST_INLINE bool Any(const Choice& a) { return ((a[0] | a[1]) | (a[2] | a[3])) != 0; }

/// Four triangles (s, p, q) of a ring.
struct Triangles {
  Lanes3 p, q;  ///< Less s.
  Lanes3 cross;
  Lanes length;
};

CCST_INLINE Triangles TrianglesOf(const Ring::Block& block, const Eigen::Vector3d& s) {
  Triangles t;
  t.p = Minus(Load(block.p), s);
  t.q = Minus(Load(block.q), s);
  t.cross = Cross(t.p, t.q);
  t.length = Sqrt(Dot(t.cross, t.cross));
  return t;
}

/// Of the triangles that face the surface less than they should the least square of the cosine
/// with its sign, -1 for one without extent; 2 when all face it.
CCST_INLINE double LeastFacing(const Ring::Block& block, const Triangles& t,
                               const Eigen::Vector3d& n) {
  Lanes3 up = Load(block.up);
  up = {up.x + n[0], up.y + n[1], up.z + n[2]};
  const Lanes dot = Dot(t.cross, up);
  const Lanes scale = Dot(t.cross, t.cross) * Dot(up, up);
  const Choice enough = (dot > 0.0) & (dot * dot > kLeastFacing * kLeastFacing * scale);
  const Choice bad = ~enough & (Load(block.live) > 0.0);
  double least = 2.0;
  if (!Any(bad)) return least;
  for (int k = 0; k < 4; ++k) {
    if (bad[k] == 0) continue;
    least = std::min(least, scale[k] > 0.0 ? dot[k] * std::abs(dot[k]) / scale[k] : -1.0);
  }
  return least;
}

CCST_INLINE void FinishIn(bool closed, const RingPlace* places, const RingNormal* normals,
                          Ring* ring) {
  ring->triangles = closed ? ring->neighbours : ring->neighbours - 1;
  // Up to three that fill the last block, and the one after it.
  std::fill_n(ring->vertex.begin() + ring->neighbours, 5,
              ring->vertex[closed ? 0 : ring->neighbours - 1]);
  const int end = 4 * ring->block_count();
  if (!ring->uniform) std::fill_n(ring->density.begin() + ring->triangles, 4, 0.0);
  const std::int32_t* u = ring->vertex.data();
  for (int i = 0; i < end; i += 4, u += 4) {
    Ring::Block& block = ring->blocks[i / 4];
    const Lanes3 p =
        Transposed(Row(places[u[0]]), Row(places[u[1]]), Row(places[u[2]]), Row(places[u[3]]));
    const Lanes3 up =
        Transposed(Row(normals[u[0]]), Row(normals[u[1]]), Row(normals[u[2]]), Row(normals[u[3]]));
    Store(p, block.p);
    Store(Shifted(p, Row(places[u[4]])), block.q);
    Store(Plus(up, Shifted(up, Row(normals[u[4]]))), block.up);
    const Lanes live = Load(kLive[std::min(ring->triangles - i, 4)]);
    Store(live, block.live);
    Store(ring->uniform ? live : Load(&ring->density[i]), block.density);
  }
}

CCST_INLINE void StoreAngles(const Triangles& t, int first, RingAngles* angles) {
  const Lanes3 e = Minus(t.q, t.p);
  const Lanes at_p = -Dot(t.p, e);
  const Lanes at_q = Dot(t.q, e);
  std::memcpy(&angles->length[first], &t.length, sizeof t.length);
  std::memcpy(&angles->at_p[first], &at_p, sizeof at_p);
  std::memcpy(&angles->at_q[first], &at_q, sizeof at_q);
}

CCST_INLINE RingSums SumIn(const Ring& ring, Energy energy, const Eigen::Vector3d& s,
                           const Eigen::Vector3d& n, const Eigen::Vector3d& t1,
                           const Eigen::Vector3d& t2) {
  RingSums sums;
  Lanes total = {};
  Lanes area = {};
  Lanes3 gradient = {};
  Lanes h11 = {};
  Lanes h12 = {};
  Lanes h22 = {};
  for (int b = 0; b < ring.block_count(); ++b) {
    const Ring::Block& block = ring.blocks[b];
    const Triangles t = TrianglesOf(block, s);
    const Lanes density = Load(block.density);
    const Lanes c = ring.scale * density * t.length;
    area += t.length;
    sums.least_facing = std::min(sums.least_facing, LeastFacing(block, t, n));
    const Lanes weight = density * density;
    Lanes pull = weight;
    if (energy == Energy::kTarget) {
      total += Load(block.live) * ((c - 1.0) * (c - 1.0));
      const Lanes bounded = c > kLeastCapacity ? c : Lanes{} + kLeastCapacity;
      pull = weight * (1.0 - 1.0 / bounded);
    } else {
      total += c * c;
    }
    const Lanes3 e = Minus(t.q, t.p);
    const Lanes3 turned = Cross(t.cross, e);
    gradient.x += pull * turned.x;
    gradient.y += pull * turned.y;
    gradient.z += pull * turned.z;
    const Lanes e1 = Dot(e, t1);
    const Lanes e2 = Dot(e, t2);
    const Lanes ee = Dot(e, e);
    h11 += weight * (ee - e1 * e1);
    h12 -= weight * (e1 * e2);
    h22 += weight * (ee - e2 * e2);
  }
  sums.energy = Total(total);
  sums.area = Total(area);
  sums.gradient = {Total(gradient.x), Total(gradient.y), Total(gradient.z)};
  sums.h11 = Total(h11);
  sums.h12 = Total(h12);
  sums.h22 = Total(h22);
  return sums;
}

CCST_INLINE bool EvaluateIn(const Ring& ring, Energy energy, const Eigen::Vector3d& s,
                            const Eigen::Vector3d& n, double least_facing, double* sum,
                            RingAngles* angles) {
  Lanes total = {};
  for (int b = 0; b < ring.block_count(); ++b) {
    const Ring::Block& block = ring.blocks[b];
    const Triangles t = TrianglesOf(block, s);
    if (LeastFacing(block, t, n) <= least_facing) return false;
    StoreAngles(t, 4 * b, angles);
    const Lanes c = ring.scale * Load(block.density) * t.length;
    total += energy == Energy::kTarget ? Load(block.live) * ((c - 1.0) * (c - 1.0)) : c * c;
  }
  *sum = Total(total);
  return true;
}

CCST_INLINE void MeasureAnglesIn(const Ring& ring, const Eigen::Vector3d& s, RingAngles* angles) {
  for (int b = 0; b < ring.block_count(); ++b) {
    StoreAngles(TrianglesOf(ring.blocks[b], s), 4 * b, angles);
  }
}

#undef CCST_INLINE

#ifdef __x86_64__
#define CCST_AVX2 __attribute__((target("avx2")))
#else
#define CCST_AVX2  // Never chosen.
#endif

CCST_AVX2 void FinishWide(bool closed, const RingPlace* places, const RingNormal* normals,
                          Ring* ring) {
  FinishIn(closed, places, normals, ring);
}

CCST_AVX2 RingSums SumWide(const Ring& ring, Energy energy, const Eigen::Vector3d& s,
                           const Eigen::Vector3d& n, const Eigen::Vector3d& t1,
                           const Eigen::Vector3d& t2) {
  return SumIn(ring, energy, s, n, t1, t2);
}

CCST_AVX2 bool EvaluateWide(const Ring& ring, Energy energy, const Eigen::Vector3d& s,
                            const Eigen::Vector3d& n, double least_facing, double* sum,
                            RingAngles* angles) {
  return EvaluateIn(ring, energy, s, n, least_facing, sum, angles);
}

CCST_AVX2 void MeasureAnglesWide(const Ring& ring, const Eigen::Vector3d& s, RingAngles* angles) {
  MeasureAnglesIn(ring, s, angles);
}

#undef CCST_AVX2

}  // namespace

Registers WidestRegisters() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) return Registers::kAvx2;
#endif
  return Registers::kPortable;
}

void Finish(bool closed, const RingPlace* places, const RingNormal* normals, Registers registers,
            Ring* ring) {
  if (registers == Registers::kAvx2) return FinishWide(closed, places, normals, ring);
  FinishIn(closed, places, normals, ring);
}

RingSums Sum(const Ring& ring, Energy energy, const Eigen::Vector3d& s, const Eigen::Vector3d& n,
             const Eigen::Vector3d& t1, const Eigen::Vector3d& t2, Registers registers) {
  if (registers == Registers::kAvx2) return SumWide(ring, energy, s, n, t1, t2);
  return SumIn(ring, energy, s, n, t1, t2);
}

bool Evaluate(const Ring& ring, Energy energy, const Eigen::Vector3d& s, const Eigen::Vector3d& n,
              double least_facing, Registers registers, double* sum, RingAngles* angles) {
  if (registers == Registers::kAvx2) {
    return EvaluateWide(ring, energy, s, n, least_facing, sum, angles);
  }
  return EvaluateIn(ring, energy, s, n, least_facing, sum, angles);
}

void MeasureAngles(const Ring& ring, const Eigen::Vector3d& s, Registers registers,
                   RingAngles* angles) {
  if (registers == Registers::kAvx2) return MeasureAnglesWide(ring, s, angles);
  MeasureAnglesIn(ring, s, angles);
}

int FindSpoilt(const Ring& ring, const RingAngles& angles, std::array<int, Ring::kMost>* spokes) {
  // Around a closed ring every spoke has a triangle on each side; on the boundary the inner ones.
  const bool closed = ring.triangles == ring.neighbours;
  int count = 0;
  for (int i = closed ? 0 : 1, before = closed ? ring.triangles - 1 : 0; i < ring.triangles;
       before = i++) {
    (*spokes)[count] = i;
    count += angles.length[before] * angles.at_q[i] + angles.at_p[before] * angles.length[i] < 0.0;
  }
  return count;
}

}  // namespace ccst
