#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"

namespace ccst {

struct RepairOptions {
  /// Vertices at most this far from a kept one join it [mesh unit], >= 0; 0 joins equal
  /// positions only. No corner of a face moves farther than twice this.
  double weld_tolerance = 0.0;
};

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

struct RepairedMesh {
  /// An oriented 2-manifold, boundary allowed. Copies of a cut vertex keep its exact position, so
  /// whoever welds equal positions again undoes cuts.
  TriangleMesh mesh;
  /// Per face of `mesh`: the face of the input on which it lies.
  std::vector<std::int32_t> source_face;
  /// Per face and corner: the corner, 0 to 2, of the source face that it is; -1 where it is none
  /// but lies on one of its sides.
  std::vector<std::array<std::int8_t, 3>> source_corner;
  RepairReport report;
};

/// Makes an oriented 2-manifold of any triangle list, changing as little as it can:
/// - vertices within the tolerance are joined, unless that would only make a place where two
///   pieces touch into a defect;
/// - faces with a repeated vertex and later copies of a face (either way round) are dropped;
/// - at an edge of three or more faces those stay together that the input's own indices keep
///   together, then pairs that agree in orientation, flattest first, the convex of equals; the
///   rest become boundary;
/// - each piece takes the orientation of most of its faces; if none exists it is cut, along edges
///   where the input's orientation breaks already unless another cut is shorter. Where just as many
///   faces look either way a closed piece is turned outwards;
/// - a face without area (its height is within the rounding of its coordinates) whose middle
///   vertex lies on the side of a neighbour is replaced by splitting that neighbour, so that no
///   crack opens; it is dropped where it hangs on one edge or none. Needles stay. T-junctions
///   that no such face closes stay cracks.
/// An oriented manifold without such faces comes back with the same faces, in the same order, and
/// its used vertices in the same order. Equal input gives equal bits.
///
/// @param interrupt  polled between the steps; may be null.
/// @param parallel  finds out on several threads whether there is anything to do.
/// Cost O((V + F) log F), about 250 bytes per face; a third of both where there is nothing to do.
/// @errors INVALID_ARGUMENT  OPTION_INVALID the tolerance is negative or not a number |
///         MESH_DEGENERATE a coordinate is not finite, an index out of range, the extent over
///         1e300 (names the first) | MESH_EMPTY no face, or none of positive area |
///         LIMIT_EXCEEDED over 7e8 faces or 2e9 vertices; CANCELLED when `interrupt` was requested
absl::StatusOr<RepairedMesh> Repair(const TriangleMesh& mesh, const RepairOptions& options = {},
                                    Interrupt* interrupt = nullptr,
                                    const Parallel& parallel = Parallel());

}  // namespace ccst
