#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"

/// What the benchmarks work on: meshes made by code, of any size.
namespace ccst::benchmarks {

/// A mesh by name with about `faces` >= 32 faces, off by a few percent at most. Equal arguments
/// give equal meshes.
///   torus  closed, smooth, its quads almost square
///   scan   the torus with bumps of three wavelengths and jittered vertices: faces of uneven size
///          and shape, curvature of both signs, as a scanner leaves them
///   saddle open, one boundary loop
///   soup   the scan with three vertices of its own for every face and every ninth face turned
///          over: repair has all to do
/// @errors INVALID_ARGUMENT for another name, with those there are.
absl::StatusOr<TriangleMesh> MakeSubject(const std::string& name, std::int64_t faces);

/// MakeSubject("scan", faces).
TriangleMesh Scan(std::int64_t faces);

/// Points at vertices of `mesh`, `count` of them spread over its list of vertices, each moved by
/// about half an edge.
std::vector<Eigen::Vector3d> PointsNear(const TriangleMesh& mesh, std::int64_t count);

/// Values per corner of `mesh` from 1 to 4 along the x axis, for a linear density.
std::vector<double> RisingValues(const TriangleMesh& mesh);

}  // namespace ccst::benchmarks
