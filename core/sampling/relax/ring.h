#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "core/sampling/energy.h"

namespace ccst::internal {

/// What the ring of a vertex needs of a sample: where it is and, as far as it takes to tell which
/// way a triangle faces, the surface's normal there. Each lies in one line of the cache.
struct alignas(32) RingPlace {
  double x, y, z, unused;
};
struct alignas(16) RingNormal {
  float x, y, z, unused;
};

/// The neighbours of one vertex, counter-clockwise, and the triangles around it, eight to a block
/// so that eight are computed at a time: all of them, in most rings. Lengths are relative to the
/// vertex and in single precision, 1e-7 of the ring's width.
struct Ring {
  static constexpr int kMost = 96;
  static constexpr int kLanes = 8;

  /// Eight triangles (s, p, q), lengths less s: an array per coordinate of p, of q, and of the sum
  /// of the normals at p and q. What fills up the last block of a closed ring are its first
  /// triangles again, so that the one after any is in the next lane; they add nothing to any sum.
  struct alignas(32) Block {
    float p[3][kLanes];
    float q[3][kLanes];
    float up[3][kLanes];
    float density[kLanes];      ///< 0 for what fills up.
    std::int32_t live[kLanes];  ///< -1 for a triangle, 0 for what fills up.
  };

  int neighbours = 0;
  bool closed = true;    ///< No boundary vertex's.
  int triangles = 0;     ///< As many as neighbours, or one less on the boundary.
  double scale = 0.0;    ///< c = scale * density * |cross product|.
  double spacing = 0.0;  ///< Of a regular ring of this area, once somebody knows.
  bool uniform = true;   ///< Every density is 1.
  std::array<std::int32_t, kMost + kLanes + 1> vertex;
  std::array<std::int32_t, kMost> half_edge;  ///< Towards the neighbour; -1 for the last of a
                                              ///< boundary vertex, which has none.
  std::array<float, kMost + kLanes> density;  ///< Of the triangle from this neighbour to the next.
  std::array<Block, kMost / kLanes> blocks;

  int block_count() const { return (triangles + kLanes - 1) / kLanes; }
};

/// What Sum() finds around a vertex at s; triangles (s, p, q) with cross product x = (p - s) x
/// (q - s), opposite edge e = q - p and relative capacity c = scale * density * |x|.
struct RingSums {
  double energy = 0.0;        ///< Sum of (c - 1)^2, or of c^2 for Energy::kSquaredArea.
  double area = 0.0;          ///< Sum of |x|.
  double least_facing = 1.0;  ///< Of the triangles that do not face the surface enough, the least
                              ///< square of the cosine, with its sign.
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< Of energy / 2, over scale^2.
  /// Majoriser of the Hessian in the directions t1 and t2, over scale^2: the sum of
  /// density^2 (|e|^2 I - e e').
  double h11 = 0.0;
  double h12 = 0.0;
  double h22 = 0.0;
};

/// The registers to compute in. Every function below gives the same bits in all of them.
enum class Registers : std::uint8_t { kPortable, kAvx2 };
/// The widest of this processor.
Registers WidestRegisters();

/// Fills the blocks of a ring whose neighbours are named, with their densities unless they are
/// uniform. `places` and `normals` are of all samples, `vertex` is the one in the middle.
void Finish(const RingPlace* places, const RingNormal* normals, std::int32_t vertex,
            Registers registers, Ring* ring);

/// @param n       unit normal of the surface at the vertex.
/// @param t1, t2  unit vectors; the same twice where the vertex moves along a line.
RingSums Sum(const Ring& ring, Energy energy, const Eigen::Vector3d& n, const Eigen::Vector3d& t1,
             const Eigen::Vector3d& t2, Registers registers);

/// Per triangle (s, p, q) around a vertex at s twice its area and that times the cotangents of its
/// angles at p and q.
struct alignas(32) RingAngles {
  std::array<float, Ring::kMost> length;
  std::array<float, Ring::kMost> at_p;
  std::array<float, Ring::kMost> at_q;
};

/// With the vertex where it is.
void MeasureAngles(const Ring& ring, Registers registers, RingAngles* angles);

/// The energy around the vertex moved by `step`, where the normal is `n`, and its angles.
/// @return false, with neither, when a triangle neither faces the surface nor faces it better than
/// `least_facing`.
bool Evaluate(const Ring& ring, Energy energy, const Eigen::Vector3d& step,
              const Eigen::Vector3d& n, double least_facing, Registers registers, double* sum,
              RingAngles* angles);

/// What rounding may add to an energy that Sum() or Evaluate() found.
inline constexpr float kRelativeEnergyRounding = 1e-6F;
inline constexpr float kEnergyRounding = 1e-8F;

/// Indices, in order, of the neighbours whose edge to the vertex is not locally Delaunay: the two
/// angles opposite to it sum up to more than pi. @return their number.
int FindSpoilt(const Ring& ring, const RingAngles& angles, Registers registers,
               std::array<int, Ring::kMost>* spokes);

}  // namespace ccst::internal
