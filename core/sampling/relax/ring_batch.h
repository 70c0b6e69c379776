#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "core/sampling/energy.h"
#include "core/sampling/relax/ring.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// The neighbours, counter-clockwise, of a vertex in the interior that has at most eight; what
/// fills up is the first again.
struct alignas(32) SmallRing {
  static constexpr int kMost = 8;
  std::int32_t vertex[kMost];
};

/// What a visit needs of a vertex of the surface, in one line of the cache.
struct alignas(64) HostVertex {
  double position[3];
  /// The shape tensor (xx, xy, xz, yy, yz, zz) with 1 after its first; so that it and the place
  /// before can be read four and eight at a time, and nothing read is denormal.
  float shape[7];
  float normal[3];
};

/// What eight visits at a time read; nothing is owned.
struct BatchSources {
  const RingPlace* places = nullptr;  ///< Of the samples, like the next four.
  const RingNormal* normals = nullptr;
  const SmallRing* rings = nullptr;
  const std::uint8_t* valences = nullptr;
  const std::int32_t* faces = nullptr;       ///< Hosts.
  const Eigen::Vector3d* weights = nullptr;  ///< On the hosts.
  const Eigen::Vector3i* corners = nullptr;  ///< Of the faces of the surface.
  const HostVertex* vertices = nullptr;      ///< Of the surface.
  const Surface* surface = nullptr;          ///< To follow over the edges of a host.
  const float* densities = nullptr;          ///< Of the sample triangles; null: 1.
  const SmallRing* triangles = nullptr;      ///< From each neighbour to the next; with densities.
  Energy energy = Energy::kTarget;
  float stretch = 1.0F;  ///< Factor on the Newton step.
  float longest = 0.0F;  ///< Longest step, in units of the local spacing.
  float least = 0.0F;    ///< Shorter Newton steps are not made, in the same units.
};

/// One step each of eight vertices of which no two are neighbours.
struct Batch {
  static constexpr int kSize = 8;
  alignas(32) std::int32_t vertex[kSize];
  alignas(32) float scale[kSize];  ///< c = scale * density * |cross product|.

  unsigned settled = 0;  ///< Bit k: vertex k makes `move`; else it needs a visit of its own.
  unsigned moves = 0;    ///< Bit k: and that is not nothing.
  alignas(32) float move[kSize];           ///< In units of the local spacing.
  alignas(32) std::int32_t spoilt[kSize];  ///< Bit i: the edge to neighbour i is not Delaunay then.
  std::int32_t face[kSize];                ///< Hosts.
  alignas(32) double position[kSize][4];
  double weights[kSize][3];
  alignas(32) float normal[3][kSize];
};

/// Computes the step that GeometryPhase makes of every vertex of the batch, as far as it improves
/// the energy at once and turns no triangle over. Gives the same bits in all registers.
void Step(const BatchSources& sources, Registers registers, Batch* batch);

/// True when two vertices of the batch are neighbours.
bool HasNeighbours(const SmallRing* rings, Registers registers, const Batch& batch);

}  // namespace ccst::internal
