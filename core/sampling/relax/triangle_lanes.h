#pragma once

#include "core/sampling/energy.h"
#include "core/sampling/relax/lanes.h"

namespace ccst::internal {

// Triangles (s, p, q) around vertices s, one in each lane: what ring.cc does with the triangles of
// one vertex and ring_batch.cc with one triangle each of several.

/// Least cosine between a triangle and the surface after a move, unless it was worse before.
inline constexpr float kLeastFacing = 0.2F;
/// Bounds a triangle's capacity away from zero in the majoriser's gradient.
inline constexpr float kLeastCapacity = 0.05F;

struct Triangles {
  Lanes3 p, q;   ///< Less s.
  Lanes3 edge;   ///< q - p.
  Lanes3 cross;  ///< p x q.
  Lanes square;  ///< |cross|^2.
  Lanes length;  ///< |cross|: twice the area.

  /// `length` times the cotangents of the angles at p and q.
  CCST_INLINE Lanes AtP() const { return -Dot(p, edge); }
  CCST_INLINE Lanes AtQ() const { return Dot(q, edge); }
};

CCST_INLINE Triangles TrianglesOf(const Lanes3& p, const Lanes3& q) {
  Triangles t = {p, q, q - p, Cross(p, q), {}, {}};
  t.square = Dot(t.cross, t.cross);
  t.length = Sqrt(t.square);
  return t;
}

/// How triangles face the surface, whose normals at the corners add up to `up`.
struct Facing {
  Lanes dot;      ///< cross . up.
  Lanes scale;    ///< |cross|^2 |up|^2.
  Choice enough;  ///< The cosine between them is large enough.
};

CCST_INLINE Facing FacingOf(const Triangles& t, const Lanes3& up) {
  Facing facing = {Dot(t.cross, up), t.square * Dot(up, up), {}};
  facing.enough =
      (facing.dot > 0.0F) & (facing.dot * facing.dot > kLeastFacing * kLeastFacing * facing.scale);
  return facing;
}

/// Contributions to the energy of triangles of relative capacity `c` where `live`.
CCST_INLINE Lanes EnergyOf(const Lanes& c, Energy energy, const Choice& live) {
  const Lanes apart = energy == Energy::kTarget ? c - 1.0F : c;
  return Masked(live, apart * apart);
}

/// Sums of one kind each, as RingSums names them.
struct LaneSums {
  Lanes energy = {};
  Lanes area = {};
  Lanes3 gradient = {};
  Lanes h11 = {};
  Lanes h12 = {};
  Lanes h22 = {};

  /// @param density  0 where not `live`.
  /// @param scale    c = scale * density * length.
  template <typename Scale, typename Direction>
  CCST_INLINE void Add(const Triangles& t, const Lanes& density, const Scale& scale, Energy of,
                       const Choice& live, const Direction& t1, const Direction& t2) {
    const Lanes c = scale * density * t.length;
    energy += EnergyOf(c, of, live);
    area += Masked(live, t.length);
    const Lanes weight = density * density;
    Lanes pull = weight;
    if (of == Energy::kTarget) {
      pull = weight * (1.0F - 1.0F / Select(c > kLeastCapacity, c, All(kLeastCapacity)));
    }
    gradient = gradient + pull * Cross(t.cross, t.edge);
    const Lanes e1 = Dot(t.edge, t1);
    const Lanes e2 = Dot(t.edge, t2);
    const Lanes ee = Dot(t.edge, t.edge);
    h11 += weight * (ee - e1 * e1);
    h12 -= weight * (e1 * e2);
    h22 += weight * (ee - e2 * e2);
  }
};

}  // namespace ccst::internal
