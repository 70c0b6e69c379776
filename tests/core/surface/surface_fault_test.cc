#include "core/surface/surface_fault.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace ccst {
namespace {

TEST(SurfaceFault, BuiltSurfacesHaveNone) {
  const std::vector<TriangleMesh> parts = {shapes::Icosphere(1),
                                           shapes::Moved(shapes::Cube(), {4.0, 0.0, 0.0})};
  for (const TriangleMesh& mesh :
       {shapes::Cube(), shapes::PlateWithHoles(2, 2, 1), shapes::Saddle(6),
        shapes::SphereWithHole(0.8, 8, 12), shapes::SingleTriangle(),
        shapes::Moved(shapes::Torus(1.0, 0.4, 12, 8), {1e6, 0, 0}, 1e-3),
        shapes::DisjointUnion(parts)}) {
    EXPECT_EQ(FindFault(*Surface::Build(mesh)), "");
  }
}

// What is left of a surface whose arrays were moved out of it is none.
TEST(SurfaceFault, AnEmptiedSurfaceIsFound) {
  Surface surface = *Surface::Build(shapes::Cube());
  const Surface taken = std::move(surface);
  EXPECT_EQ(FindFault(taken), "");
  EXPECT_NE(FindFault(surface), "");  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace ccst
