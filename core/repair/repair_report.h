#pragma once

#include <cstdint>

namespace ccst {

/// What Repair() did. With V, F the counts of the input and V', F' those of the result:
///   V' = V - isolated_vertices - welded_vertices + cut_vertices
///   F' = F - repeated_index_faces - duplicate_faces - degenerate_faces + split_faces
struct RepairReport {
  std::int64_t welded_vertices = 0;       ///< Joined with another vertex at their place.
  std::int64_t repeated_index_faces = 0;  ///< Dropped: a corner used twice, after welding.
  std::int64_t duplicate_faces = 0;       ///< Dropped: the three vertices of an earlier face.
  std::int64_t degenerate_faces = 0;      ///< Dropped or replaced: no area.
  std::int64_t split_faces = 0;           ///< Faces cut in two at a vertex on their side.
  std::int64_t cut_edges = 0;             ///< Edges of three or more faces, cut apart.
  std::int64_t non_orientable_cuts = 0;   ///< Edges cut so that an orientation exists.
  std::int64_t cut_vertices = 0;          ///< Copies made so that each vertex has one fan.
  std::int64_t flipped_faces = 0;         ///< Turned over to agree with their neighbours.
  std::int64_t isolated_vertices = 0;     ///< Dropped: no face uses them.

  bool operator==(const RepairReport&) const = default;
  /// True when nothing was done.
  bool IsClean() const { return *this == RepairReport{}; }
};

}  // namespace ccst
