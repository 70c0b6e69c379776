#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/index.h"
#include "core/mesh/faces.h"

namespace ccst::internal {

/// A triangle of a SampleMesh, which a half-edge must not be taken for: there are three times as
/// many of those.
using TriangleIndex = Index<struct TriangleTag>;

/// The samples and the triangulation over them as half-edge arrays.
///
/// Half-edge 3 t + k goes from corner k of triangle t to corner k + 1; the triangle lies on its
/// left. Several threads may call what is const. Every operation keeps the complex a manifold when
/// its precondition holds, and changes connectivity only: positions are the caller's.
class SampleMesh {
 public:
  /// What a vertex may do.
  enum class Kind : std::uint8_t {
    kInterior,  ///< Moves over the surface.
    kBoundary,  ///< Slides along a boundary loop.
    kCrease,    ///< Slides along a crease.
    kFixed,     ///< A corner of a boundary loop.
    kPoint,     ///< Stays where it was drawn and belongs to no triangle.
  };

  /// Builds the arrays.
  /// @param triangles  M x 3, an oriented manifold over `vertex_count` vertices; those that start
  ///                   with -1 are dead from the start.
  void SetTriangles(std::int32_t vertex_count, const std::vector<Eigen::Vector3i>& triangles);

  std::int32_t vertex_count() const { return static_cast<std::int32_t>(outgoing.size()); }
  std::int32_t triangle_count() const { return static_cast<std::int32_t>(origin.size() / 3); }

  static std::int32_t Next(std::int32_t h) { return NextHalfEdge(h); }
  static std::int32_t Previous(std::int32_t h) { return PreviousHalfEdge(h); }
  std::int32_t Target(std::int32_t h) const { return origin[Next(h)]; }
  std::int32_t Apex(std::int32_t h) const { return origin[Previous(h)]; }
  /// The triangle on the left of `h`.
  static TriangleIndex TriangleOf(std::int32_t h) { return TriangleIndex(h / 3); }
  bool IsDead(TriangleIndex t) const { return origin[3 * t] < 0; }
  bool IsBoundary(std::int32_t v) const { return twin[outgoing[v]] < 0; }
  bool IsLocked(std::int32_t h) const { return !locked.empty() && locked[h] != 0; }
  /// Keeps the edge `h`: it is not flipped, and its ends merge along it only.
  void Lock(std::int32_t h);

  /// Next outgoing half-edge around the origin of `h`, counter-clockwise; -1 past the boundary.
  std::int32_t Rotate(std::int32_t h) const { return twin[Previous(h)]; }

  /// Calls f(half-edge) for every half-edge that leaves `v`, counter-clockwise, from the boundary
  /// one where there is one. The last neighbour of a boundary vertex has no outgoing half-edge
  /// towards it: it is Apex() of the last one.
  template <typename F>
  void ForEachOutgoing(std::int32_t v, F&& f) const {
    const std::int32_t start = outgoing[v];
    std::int32_t h = start;
    do {
      f(h);
      h = Rotate(h);
    } while (h >= 0 && h != start);
  }

  /// Calls f(vertex) for every neighbour of `v`, counter-clockwise.
  template <typename F>
  void ForEachNeighbour(std::int32_t v, F&& f) const {
    ForEachOutgoing(v, [&](std::int32_t h) {
      f(Target(h));
      if (Rotate(h) < 0) f(Apex(h));
    });
  }

  /// Number of edges at `v`.
  std::int32_t Degree(std::int32_t v) const;

  /// Whether there are more than `count` edges at `v`. Cost O(count).
  bool HasMoreEdges(std::int32_t v, std::int32_t count) const;

  /// A half-edge from `a` to `b`, or one from `b` to `a`, or -1 where there is no such edge. Cost
  /// O(edges at the one of the two that has fewer): a hub may have very many.
  std::int32_t FindEdge(std::int32_t a, std::int32_t b) const;

  /// How many of `vertices` are neighbours of `v`. Cost O(edges at `v` + vertices), where `v` has
  /// very many O(those of the vertices).
  std::int32_t CountNeighbours(std::int32_t v, std::span<const std::int32_t> vertices) const;

  /// True when edge `h` can be turned: interior, not locked, the new edge does not exist yet and no
  /// vertex is left with fewer than three edges.
  bool CanFlip(std::int32_t h) const;
  /// Replaces the diagonal `h` of its two triangles by the other one. @pre CanFlip(h).
  void Flip(std::int32_t h);

  /// True when the origin of `h` can be merged into its target without changing the topology
  /// (link condition; Dey, Edelsbrunner, Guha, Nekhayev 1999), boundary vertices along the
  /// boundary only, those on locked edges along these only.
  bool CanCollapse(std::int32_t h) const;
  /// Whether collapsing `h` leaves no triangle on the left of `e`, which starts where `h` does.
  bool FallsWith(std::int32_t h, std::int32_t e) const {
    return e == h || (twin[h] >= 0 && e == Next(twin[h]));
  }
  /// Merges the origin of `h` into its target. Leaves one or two dead triangles and the origin
  /// without edges. @pre CanCollapse(h).
  void Collapse(std::int32_t h);

  /// Splits triangle `t` by vertex `v` (without edges so far) using two dead or new triangles.
  void InsertIntoTriangle(std::int32_t v, TriangleIndex t, TriangleIndex slot1,
                          TriangleIndex slot2);
  /// Splits the boundary half-edge `h` by vertex `v` using one dead or new triangle.
  void InsertIntoBoundaryEdge(std::int32_t v, std::int32_t h, TriangleIndex slot);

  /// Splits the interior edge `h`, from a to b, by vertex `v` using two dead or new triangles; `h`
  /// goes from a to v then, 3 slot1 from v to b.
  void InsertIntoEdge(std::int32_t v, std::int32_t h, TriangleIndex slot1, TriangleIndex slot2);

  /// Appends a dead triangle.
  TriangleIndex NewTriangle();

  std::vector<std::int32_t> origin;    ///< 3 M: vertex a half-edge starts at; -1 in dead triangles.
  std::vector<std::int32_t> twin;      ///< 3 M: opposite half-edge; -1 on the boundary.
  std::vector<std::uint8_t> locked;    ///< 3 M: the edge stays; empty when none is locked.
  std::vector<std::int32_t> outgoing;  ///< N: a half-edge that leaves the vertex; -1 without edges.

 private:
  /// Makes twins of two half-edges, of which `b`, the outer one, knows whether the edge is locked.
  void Pair(std::int32_t a, std::int32_t b);
  void SetTriangle(TriangleIndex t, std::int32_t a, std::int32_t b, std::int32_t c);
  void PointAt(std::int32_t h);
  /// How many vertices are neighbours of both `v` and `w`, which are neighbours.
  std::int32_t CountCommonNeighbours(std::int32_t v, std::int32_t w) const;
};

}  // namespace ccst::internal
