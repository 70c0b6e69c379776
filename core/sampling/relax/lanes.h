#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include <Eigen/Core>

namespace ccst::internal {

// Eight numbers at a time, in whatever registers the calling function is compiled for: the order of
// operations is written here, so that any registers give the same bits. For ring.cc,
// ring_batch.cc and capacity_sums.cc, which are compiled for several.

#define CCST_INLINE [[gnu::always_inline]] inline

/// Marks what is compiled for Registers::kAvx2.
#ifdef __x86_64__
#define CCST_AVX2 __attribute__((target("avx2")))
#else
#define CCST_AVX2  // Never chosen.
#endif

inline constexpr int kLanes = 8;

using Lanes = float __attribute__((vector_size(32)));
/// What comparing them gives: all bits or none.
using Choice = std::int32_t __attribute__((vector_size(32)));
/// A vector's coordinates and one more number.
using Row = float __attribute__((vector_size(16)));
using LongRow = double __attribute__((vector_size(32)));

struct Lanes3 {
  Lanes x, y, z;
};

/// A vector rounded to single precision.
struct Vector3 {
  explicit Vector3(const Eigen::Vector3d& v)
      : x(static_cast<float>(v[0])), y(static_cast<float>(v[1])), z(static_cast<float>(v[2])) {}
  float x, y, z;
};

template <typename To, typename From>
CCST_INLINE To LoadAs(const From* from) {
  To to;
  std::memcpy(&to, from, sizeof to);
  return to;
}

CCST_INLINE Lanes Load(const float* from) { return LoadAs<Lanes>(from); }

CCST_INLINE void Store(const Lanes& lanes, float* to) { std::memcpy(to, &lanes, sizeof lanes); }

CCST_INLINE Lanes3 Load(const float (&from)[3][kLanes]) {
  return {Load(from[0]), Load(from[1]), Load(from[2])};
}

CCST_INLINE void Store(const Lanes3& lanes, float (&to)[3][kLanes]) {
  Store(lanes.x, to[0]);
  Store(lanes.y, to[1]);
  Store(lanes.z, to[2]);
}

CCST_INLINE Lanes All(float value) { return Lanes{} + value; }

CCST_INLINE Lanes Select(const Choice& which, const Lanes& then, const Lanes& otherwise) {
  return which ? then : otherwise;
}

CCST_INLINE Lanes Masked(const Choice& which, const Lanes& a) { return (Lanes)((Choice)a & which); }

CCST_INLINE Lanes Smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }

CCST_INLINE Lanes Sqrt(const Lanes& a) {
  Lanes root;
  for (int k = 0; k < kLanes; ++k) root[k] = std::sqrt(a[k]);
  return root;
}

CCST_INLINE bool Any(const Choice& a) {
  using Words = std::int64_t __attribute__((vector_size(32)));
  const Words word = (Words)a;
  return ((word[0] | word[2]) | (word[1] | word[3])) != 0;
}

/// Bit k is set where lane k of `a` is.
CCST_INLINE unsigned Bits(const Choice& a) {
  const Choice bits = a & Choice{1, 2, 4, 8, 16, 32, 64, 128};
  return static_cast<unsigned>(((bits[0] | bits[4]) | (bits[1] | bits[5])) |
                               ((bits[2] | bits[6]) | (bits[3] | bits[7])));
}

CCST_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
CCST_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
CCST_INLINE Lanes3 operator*(const Lanes& a, const Lanes3& b) {
  return {a * b.x, a * b.y, a * b.z};
}
CCST_INLINE Lanes3 operator+(const Lanes3& a, const Vector3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
CCST_INLINE Lanes3 operator-(const Lanes3& a, const Vector3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
CCST_INLINE Lanes Dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
CCST_INLINE Lanes Dot(const Lanes3& a, const Vector3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
CCST_INLINE Lanes3 Cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

CCST_INLINE Lanes Pair(const Row& a, const Row& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// The first three numbers of eight rows, as an array each.
CCST_INLINE Lanes3 Transposed(const Row (&row)[kLanes]) {
  const Lanes a = Pair(row[0], row[4]);
  const Lanes b = Pair(row[1], row[5]);
  const Lanes c = Pair(row[2], row[6]);
  const Lanes d = Pair(row[3], row[7]);
  const Lanes xy_ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes xy_cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes z_ab = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Lanes z_cd = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  return {__builtin_shufflevector(xy_ab, xy_cd, 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 10, 11, 6, 7, 14, 15),
          __builtin_shufflevector(z_ab, z_cd, 0, 1, 8, 9, 4, 5, 12, 13)};
}

}  // namespace ccst::internal
