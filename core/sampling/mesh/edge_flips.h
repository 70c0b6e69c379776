#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "core/base/interrupt.h"
#include "core/sampling/mesh/sample_mesh.h"

namespace ccst::internal {

/// The topology phase: flips edges until every edge is locally Delaunay (opposite angles sum to
/// at most pi), except where the flip would turn a triangle over against the surface.
/// Every flip lowers the area of the sample mesh, so the loop ends.
/// Source: Dyer, Zhang, Moeller, "Delaunay mesh construction", SGP 2007.
class EdgeFlips {
 public:
  /// @param position, normal  per vertex of `mesh`; neither is owned, all must outlive this.
  /// @param known  per vertex, not owned, may be null: set to 0 where a triangle is flipped, for
  ///               those who remember rings.
  EdgeFlips(SampleMesh* mesh, const std::vector<Eigen::Vector3d>* position,
            const std::vector<Eigen::Vector3d>* normal, std::uint8_t* known = nullptr)
      : mesh_(*mesh), position_(*position), normal_(*normal), known_(known) {}

  /// From now on flips only edges whose two triangles have no vertices but those in [first, end);
  /// others that come up are appended to `beyond`. Those with disjoint ranges may work on one mesh
  /// side by side.
  void Restrict(std::int32_t first, std::int32_t end);

  /// Flips until nothing changes. @return the number of flips. Cost O(edges + flips).
  /// @param interrupt  may be null; once requested, the rest stays as it is.
  std::int64_t FlipAll(Interrupt* interrupt = nullptr);

  /// The same, starting from the triangles around `v` only.
  std::int64_t FlipAround(std::int32_t v, Interrupt* interrupt = nullptr);

  /// The same, starting from the given half-edges.
  std::int64_t FlipThese(const std::vector<std::int32_t>& half_edges,
                         Interrupt* interrupt = nullptr);

  /// Vertices of flipped triangles since the last clear; may repeat.
  std::vector<std::int32_t> touched;
  /// Half-edges left to others, see Restrict(); may repeat.
  std::vector<std::int32_t> beyond;

 private:
  bool IsWithin(std::int32_t h) const;
  bool IsWanted(std::int32_t h) const;
  std::int64_t MostFlips() const;
  std::int64_t Drain(std::int64_t most, Interrupt* interrupt);
  void Push(std::int32_t h);

  SampleMesh& mesh_;
  const std::vector<Eigen::Vector3d>& position_;
  const std::vector<Eigen::Vector3d>& normal_;
  std::uint8_t* const known_;
  std::int32_t first_ = 0;
  std::int32_t end_ = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t> stack_;
};

/// True when edge (a, b) of triangles (a, b, c) and (b, a, d) is not locally Delaunay, its opposite
/// angles summing to more than pi, and the edge (c, d) instead would turn none of the two away from
/// the surface, or less than one of them is already.
bool FlipImproves(const std::vector<Eigen::Vector3d>& position,
                  const std::vector<Eigen::Vector3d>& normal, std::int32_t a, std::int32_t b,
                  std::int32_t c, std::int32_t d);

/// Cosine-like measure of how far triangle (a, b, c) is turned from the surface: its unit normal
/// times the unit sum of the surface normals at its corners; negative when turned over.
double Facing(const std::vector<Eigen::Vector3d>& position,
              const std::vector<Eigen::Vector3d>& normal, std::int32_t a, std::int32_t b,
              std::int32_t c);

}  // namespace ccst::internal
