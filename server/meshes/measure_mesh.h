#pragma once

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "server/formats/mesh_facts.h"

namespace ccst::server {

/// Repairs `mesh` as sampling does by default and measures it. Cost as Repair() and
/// Surface::Build(), which is O((V + F) log F).
/// @errors those of SampleSurface() for a mesh that cannot be sampled at all: INVALID_ARGUMENT
///         MESH_EMPTY | MESH_DEGENERATE | LIMIT_EXCEEDED
absl::StatusOr<MeshFacts> MeasureMesh(const TriangleMesh& mesh);

}  // namespace ccst::server
