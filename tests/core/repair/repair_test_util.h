#pragma once

#include "core/mesh/triangle_mesh.h"
#include "core/repair/repair.h"

namespace ccst::testing {

/// The mesh with bitwise different positions: copies of a place move by the smallest steps there
/// are, so that code which welds equal positions leaves cuts alone.
TriangleMesh Separated(TriangleMesh mesh);

/// Repairs `mesh` and expects what must hold for every repair: an oriented manifold by the
/// measure of core/quality, accepted by Surface::Build; counts that add up; faces that lie where
/// the faces they name lie; nothing left to repair. `result` is empty on failure.
void RepairAndCheck(const TriangleMesh& mesh, const RepairOptions& options, RepairedMesh* result);

/// RepairAndCheck() with failures reported at the caller's.
RepairedMesh Repaired(const TriangleMesh& mesh, const RepairOptions& options = {});

}  // namespace ccst::testing
