#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/mesh/faces.h"

namespace ccst::repair {

/// Faces and how they hang together. Slot 3 f + k is the edge of face f from corner k to k + 1.
struct LinkedFaces {
  std::vector<Eigen::Vector3i> faces;  ///< F x 3 vertices, all different in a face.
  std::vector<std::int32_t> source;    ///< F: face of the input.
  /// F x 3: the corner of that face which a corner is, -1 where it lies on one of its sides.
  std::vector<std::array<std::int8_t, 3>> source_corner;
  std::vector<std::int32_t> links;  ///< 3 F: the slot across the edge, -1 at a boundary.

  std::int32_t count() const { return static_cast<std::int32_t>(faces.size()); }
  std::int32_t Origin(std::int32_t slot) const { return faces[slot / 3][slot % 3]; }
  std::int32_t Target(std::int32_t slot) const { return Origin(NextHalfEdge(slot)); }
  std::int32_t Apex(std::int32_t slot) const { return Origin(PreviousHalfEdge(slot)); }
  /// Whether the slot runs from the smaller vertex to the larger.
  bool Ascends(std::int32_t slot) const { return Origin(slot) < Target(slot); }

  void Link(std::int32_t a, std::int32_t b) {
    links[a] = b;
    links[b] = a;
  }
  void Unlink(std::int32_t slot) {
    if (links[slot] < 0) return;
    links[links[slot]] = -1;
    links[slot] = -1;
  }
};

}  // namespace ccst::repair
