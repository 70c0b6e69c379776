#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/mesh/triangle_mesh.h"
#include "core/parallel/parallel.h"
#include "core/repair/repair_report.h"

namespace ccst {

struct RepairOptions {
  /// Vertices at most this far from a kept one join it [mesh unit], >= 0; 0 joins equal
  /// positions only. No corner of a face moves farther than twice this.
  double weld_tolerance = 0.0;
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
