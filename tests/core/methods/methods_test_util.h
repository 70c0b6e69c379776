#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/density/density.h"
#include "core/mesh/triangle_mesh.h"
#include "core/methods/methods.h"
#include "core/quality/distances.h"
#include "core/surface/surface.h"

/// What the tests of the methods share.
namespace ccst::methods_test {

using Points = std::vector<SurfacePoint>;

/// A method by name; the iterative ones with few enough steps for a test.
struct Method {
  std::string name;
  std::function<absl::StatusOr<Points>(const Surface&, const Density&, std::int64_t count,
                                       std::uint64_t seed, const MethodControl&)>
      run;
};

/// All five.
const std::vector<Method>& AllMethods();

/// The method called `name`, run without a stop; fails the test when it returns an error.
Points Sample(const std::string& name, const Surface& surface, const Density& density,
              std::int64_t count, std::uint64_t seed = 1);

/// The surface of a mesh known to be one.
Surface SurfaceOf(const TriangleMesh& mesh);

/// rho proportional to `rho` of a position in mesh units, linear over each face.
Density DensityOf(const Surface& surface, const std::function<double(const Eigen::Vector3d&)>& rho);

/// n x 3 unit normals of the hosts' faces.
std::vector<Eigen::Vector3d> HostNormals(const Surface& surface, const Points& points);
/// n x 3.
std::vector<Eigen::Vector3d> Positions(const Points& points);

/// Distances between points of one side.
quality::DistanceFigures Figures(const Surface& surface, const Points& points);

/// [-1, 1]^2 x [0, thickness], faces on both sides of about 0.25 a side.
TriangleMesh ThinPlate(double thickness);

}  // namespace ccst::methods_test
