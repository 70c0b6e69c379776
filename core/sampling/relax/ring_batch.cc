#include "core/sampling/relax/ring_batch.h"

#include <algorithm>
#include <cmath>

#include "core/sampling/relax/lanes.h"
#include "core/sampling/relax/triangle_lanes.h"

namespace ccst::internal {

static_assert(Batch::kSize == kLanes && SmallRing::kMost == kLanes);

namespace {

/// Symmetric 3 x 3 tensors, one in each lane.
struct Tensors {
  Lanes xx, xy, xz, yy, yz, zz;

  CCST_INLINE Lanes3 operator*(const Lanes3& a) const {
    return {xx * a.x + xy * a.y + xz * a.z, xy * a.x + yy * a.y + yz * a.z,
            xz * a.x + yz * a.y + zz * a.z};
  }
};

/// Rows (xx, unused, xy, xz, yy, yz, zz, unused) as an array each.
CCST_INLINE Tensors TransposedTensors(const Lanes (&row)[kLanes]) {
  Row low[kLanes];
  Row high[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    low[k] = __builtin_shufflevector(row[k], row[k], 0, 2, 3, 0);
    high[k] = __builtin_shufflevector(row[k], row[k], 4, 5, 6, 7);
  }
  const Lanes3 a = Transposed(low);
  const Lanes3 b = Transposed(high);
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

/// Two unit vectors that complete `n` to a right-handed frame; as TangentFrame() does.
CCST_INLINE void Frame(const Lanes3& n, Lanes3* t1, Lanes3* t2) {
  const Choice one = (Choice)All(1.0F);
  const Lanes sign = (Lanes)(one | ((Choice)n.z & std::int32_t{-0x7fffffff - 1}));
  const Lanes a = -1.0F / (sign + n.z);
  const Lanes b = n.x * n.y * a;
  *t1 = {1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *t2 = {b, sign + n.y * n.y * a, -n.y};
}

/// Where the vertices of a batch are on the surface.
struct Hosts {
  const HostVertex* corner[kLanes][3];
  Lanes3 first, second;  ///< Edges from corner 0 to corners 1 and 2.
  Tensors shape;
};

CCST_INLINE void GatherHosts(const BatchSources& sources, const Batch& batch, Hosts* hosts) {
  Row first[kLanes];
  Row second[kLanes];
  Lanes shape[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    const std::int32_t v = batch.vertex[k];
    const Eigen::Vector3i& corners = sources.corners[sources.faces[v]];
    const Eigen::Vector3d& weights = sources.weights[v];
    const HostVertex* c[3];
    for (int i = 0; i < 3; ++i) c[i] = hosts->corner[k][i] = &sources.vertices[corners[i]];
    const auto origin = LoadAs<LongRow>(c[0]->position);
    first[k] = __builtin_convertvector(LoadAs<LongRow>(c[1]->position) - origin, Row);
    second[k] = __builtin_convertvector(LoadAs<LongRow>(c[2]->position) - origin, Row);
    shape[k] = static_cast<float>(weights[0]) * Load(c[0]->shape) +
               static_cast<float>(weights[1]) * Load(c[1]->shape) +
               static_cast<float>(weights[2]) * Load(c[2]->shape);
  }
  hosts->first = Transposed(first);
  hosts->second = Transposed(second);
  hosts->shape = TransposedTensors(shape);
}

/// The rings of a batch: neighbour k of all vertices, relative to each; of a ring with fewer, after
/// the last comes the first and then anything.
struct Rings {
  Choice valence;
  int most = 0;  ///< Of the valences.
  Lanes3 place[kLanes + 1];
  Lanes3 normal[kLanes + 1];
  Lanes density[kLanes];  ///< Of the triangle from neighbour k to the next; 0 where there is none.

  CCST_INLINE Choice IsLive(int k) const { return valence > k; }
};

CCST_INLINE void GatherRings(const BatchSources& sources, const Batch& batch, Rings* rings) {
  LongRow base[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    const std::int32_t v = batch.vertex[k];
    base[k] = LoadAs<LongRow>(&sources.places[v]);
    rings->valence[k] = sources.valences[v];
    rings->most = std::max<int>(rings->most, sources.valences[v]);
  }
  for (int i = 0; i <= rings->most; ++i) {
    Row place[kLanes];
    Row normal[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const std::int32_t u = sources.rings[batch.vertex[k]].vertex[i % SmallRing::kMost];
      place[k] = __builtin_convertvector(LoadAs<LongRow>(&sources.places[u]) - base[k], Row);
      normal[k] = LoadAs<Row>(&sources.normals[u]);
    }
    rings->place[i] = Transposed(place);
    rings->normal[i] = Transposed(normal);
  }
  for (int i = 0; i < rings->most; ++i) {
    Lanes density = All(1.0F);
    if (sources.densities != nullptr) {
      for (int k = 0; k < kLanes; ++k) {
        density[k] = sources.densities[sources.triangles[batch.vertex[k]].vertex[i]];
      }
    }
    rings->density[i] = Masked(rings->IsLive(i), density);
  }
}

/// Steps along the surface to second order, and what they come to in the plane of the hosts.
struct Steps {
  Choice known;      ///< The energy has a minimum to go to.
  Choice none;       ///< It is too near.
  Lanes3 wanted;     ///< Where they are to end, relative to the vertices.
  Lanes weights[2];  ///< What corners 1 and 2 gain.
  Lanes3 step;
  Lanes spacing;  ///< Of regular rings of these areas.
  Lanes energy;   ///< Before the step.
};

CCST_INLINE Steps FindSteps(const BatchSources& sources, const Rings& rings, const Hosts& hosts,
                            const Lanes& scale, const Lanes3& n) {
  Lanes3 t1;
  Lanes3 t2;
  Frame(n, &t1, &t2);
  LaneSums sums;
  for (int i = 0; i < rings.most; ++i) {
    sums.Add(TrianglesOf(rings.place[i], rings.place[i + 1]), rings.density[i], scale,
             sources.energy, rings.IsLive(i), t1, t2);
  }
  const Lanes g1 = Dot(sums.gradient, t1);
  const Lanes g2 = Dot(sums.gradient, t2);
  const Lanes bend = Dot(sums.gradient, n);
  const Lanes3 bent1 = hosts.shape * t1;
  const Lanes3 bent2 = hosts.shape * t2;
  const Lanes ii11 = Dot(bent1, t1);
  const Lanes ii12 = Dot(bent1, t2);
  const Lanes ii22 = Dot(bent2, t2);
  const Lanes m11 = sums.h11 + bend * ii11;
  const Lanes m12 = sums.h12 + bend * ii12;
  const Lanes m22 = sums.h22 + bend * ii22;
  // Where bending makes the form indefinite, the majoriser without it is still convex.
  const Lanes flat = sums.h11 * sums.h22 - sums.h12 * sums.h12;
  const Lanes bent = m11 * m22 - m12 * m12;
  const Choice is_bent = (m11 > 0.0F) & (bent > 1e-3F * flat);
  const Lanes determinant = Select(is_bent, bent, flat);
  const Lanes a11 = Select(is_bent, m11, sums.h11);
  const Lanes a12 = Select(is_bent, m12, sums.h12);
  const Lanes a22 = Select(is_bent, m22, sums.h22);
  const Lanes over = 1.0F / determinant;
  const Lanes u = (g2 * a12 - g1 * a22) * over;
  const Lanes w = (g1 * a12 - g2 * a11) * over;
  const Lanes size = Sqrt(u * u + w * w);

  Steps steps;
  steps.energy = sums.energy;
  const Lanes valence = __builtin_convertvector(rings.valence, Lanes);
  steps.spacing = Sqrt(1.15470054F * sums.area / valence);
  steps.known = determinant > 0.0F;
  steps.none = ~(size > sources.least * steps.spacing);
  const Lanes factor = Smaller(sources.longest * steps.spacing / size, All(sources.stretch));
  const Lanes du = factor * u;
  const Lanes dw = factor * w;
  const Lanes rise = 0.5F * (ii11 * du * du + 2.0F * ii12 * du * dw + ii22 * dw * dw);
  steps.wanted = du * t1 + dw * t2 + rise * n;
  // The nearest point of the host's plane.
  const Lanes3 across = Cross(hosts.first, hosts.second);
  const Lanes over_square = 1.0F / Dot(across, across);
  steps.weights[0] =
      Masked(~steps.none, Dot(steps.wanted, Cross(hosts.second, across)) * over_square);
  steps.weights[1] =
      Masked(~steps.none, Dot(steps.wanted, Cross(across, hosts.first)) * over_square);
  steps.step = steps.weights[0] * hosts.first + steps.weights[1] * hosts.second;
  return steps;
}

/// Follows a step that leaves its host over the surface and makes it end there. @return the normal
/// there.
Row Leave(const BatchSources& sources, int k, Steps* steps, Batch* batch) {
  const RingPlace& place = sources.places[batch->vertex[k]];
  const Eigen::Vector3d start(place.x, place.y, place.z);
  const Lanes3& wanted = steps->wanted;
  const SurfacePoint point = sources.surface->Follow(
      batch->face[k], start + Eigen::Vector3d(wanted.x[k], wanted.y[k], wanted.z[k]));
  const Eigen::Vector3f step = (point.position - start).cast<float>();
  steps->step.x[k] = step[0];
  steps->step.y[k] = step[1];
  steps->step.z[k] = step[2];
  batch->face[k] = point.face;
  Eigen::Vector3d::Map(batch->weights[k]) = point.weights;
  Eigen::Vector3d::Map(batch->position[k]) = point.position;
  const Eigen::Vector3f normal = sources.surface->NormalAt(point.face, point.weights).cast<float>();
  return Row{normal[0], normal[1], normal[2], 0.0F};
}

/// Takes the vertices to where the steps end, and the steps to the surface.
CCST_INLINE void Arrive(const BatchSources& sources, const Hosts& hosts, Steps* steps, Batch* batch,
                        Lanes3* n) {
  Row normal[kLanes];
  for (int k = 0; k < kLanes; ++k) {
    batch->face[k] = sources.faces[batch->vertex[k]];
    const Eigen::Vector3d& before = sources.weights[batch->vertex[k]];
    double* weights = batch->weights[k];
    weights[1] = before[1] + static_cast<double>(steps->weights[0][k]);
    weights[2] = before[2] + static_cast<double>(steps->weights[1][k]);
    weights[0] = 1.0 - weights[1] - weights[2];
    const bool is_inside = (weights[0] > 0.0) & (weights[1] > 0.0) & (weights[2] > 0.0);
    if (!is_inside && steps->known[k] != 0 && steps->none[k] == 0) {
      normal[k] = Leave(sources, k, steps, batch);
      continue;
    }
    const HostVertex* const* corner = hosts.corner[k];
    const LongRow position = weights[0] * LoadAs<LongRow>(corner[0]->position) +
                             weights[1] * LoadAs<LongRow>(corner[1]->position) +
                             weights[2] * LoadAs<LongRow>(corner[2]->position);
    std::memcpy(batch->position[k], &position, sizeof position);
    // The number before the normal comes with it.
    const Row row = static_cast<float>(weights[0]) * LoadAs<Row>(&corner[0]->shape[6]) +
                    static_cast<float>(weights[1]) * LoadAs<Row>(&corner[1]->shape[6]) +
                    static_cast<float>(weights[2]) * LoadAs<Row>(&corner[2]->shape[6]);
    normal[k] = __builtin_shufflevector(row, row, 1, 2, 3, 0);
  }
  const Lanes3 sum = Transposed(normal);
  *n = (1.0F / Sqrt(Dot(sum, sum))) * sum;
}

CCST_INLINE void StepIn(const BatchSources& sources, Batch* batch) {
  Rings rings;
  GatherRings(sources, *batch, &rings);
  Hosts hosts;
  GatherHosts(sources, *batch, &hosts);
  Row rows[kLanes];
  for (int k = 0; k < kLanes; ++k) rows[k] = LoadAs<Row>(&sources.normals[batch->vertex[k]]);
  const Lanes scale = Load(batch->scale);
  Steps steps = FindSteps(sources, rings, hosts, scale, Transposed(rows));
  Lanes3 n;
  Arrive(sources, hosts, &steps, batch, &n);

  Lanes energy = {};
  Choice spoilt = {};
  Choice facing = ~Choice{};
  Lanes first_length = {};
  Lanes first_at_q = {};
  Lanes length = {};  // Of the triangle before, like `at_p`.
  Lanes at_p = {};
  for (int i = 0; i < rings.most; ++i) {
    const Choice live = rings.IsLive(i);
    const Triangles t = TrianglesOf(rings.place[i] - steps.step, rings.place[i + 1] - steps.step);
    facing &= ~live | FacingOf(t, rings.normal[i] + rings.normal[i + 1] + n).enough;
    energy += EnergyOf(scale * rings.density[i] * t.length, sources.energy, live);
    const Lanes at_q = t.AtQ();
    if (i == 0) {
      first_length = t.length;
      first_at_q = at_q;
    } else {
      spoilt |= (length * at_q + at_p * t.length < 0.0F) & live & (1 << i);
    }
    length = Select(live, t.length, length);
    at_p = Select(live, t.AtP(), at_p);
  }
  spoilt |= (length * first_at_q + at_p * first_length < 0.0F) & 1;
  std::memcpy(batch->spoilt, &spoilt, sizeof spoilt);
  Store(n, batch->normal);
  Store(Masked(~steps.none, Sqrt(Dot(steps.step, steps.step)) / steps.spacing), batch->move);
  const Choice improves =
      energy <= steps.energy - (kRelativeEnergyRounding * steps.energy + kEnergyRounding);
  const Choice settled = steps.known & (steps.none | (facing & improves));
  batch->settled = Bits(settled);
  batch->moves = Bits(settled & ~steps.none);
}

CCST_INLINE bool HasNeighboursIn(const SmallRing* rings, const Batch& batch) {
  Choice same = {};
  for (int k = 0; k < kLanes; ++k) {
    const auto ring = LoadAs<Choice>(rings[batch.vertex[k]].vertex);
    for (int i = 0; i < k; ++i) same |= ring == batch.vertex[i];
  }
  return Any(same);
}

CCST_AVX2 void StepWide(const BatchSources& sources, Batch* batch) { StepIn(sources, batch); }

CCST_AVX2 bool HasNeighboursWide(const SmallRing* rings, const Batch& batch) {
  return HasNeighboursIn(rings, batch);
}

}  // namespace

void Step(const BatchSources& sources, Registers registers, Batch* batch) {
  if (registers == Registers::kAvx2) return StepWide(sources, batch);
  StepIn(sources, batch);
}

bool HasNeighbours(const SmallRing* rings, Registers registers, const Batch& batch) {
  if (registers == Registers::kAvx2) return HasNeighboursWide(rings, batch);
  return HasNeighboursIn(rings, batch);
}

}  // namespace ccst::internal
