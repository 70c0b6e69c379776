// Random triangle lists with fixed seeds: whatever goes in, an oriented manifold comes out.
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "core/repair/repair.h"
#include "tests/core/repair/repair_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using ::ccst::testing::RepairAndCheck;

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  int Below(int end) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(end)); }

 private:
  std::mt19937 engine_;
};

/// A soup may be flat; then it must be refused for that and nothing else.
void ExpectRepairedOrEmpty(const TriangleMesh& mesh, const RepairOptions& options) {
  const auto result = Repair(mesh, options);
  if (!result.ok()) {
    EXPECT_EQ(GetErrorReason(result.status()), ErrorReason::kMeshEmpty);
    return;
  }
  RepairedMesh repaired;
  RepairAndCheck(mesh, options, &repaired);
}

TEST(RepairSoup, SmallLatticesGiveManifolds) {
  for (std::uint32_t seed = 0; seed < 3000; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    // Few places: many equal, collinear and coplanar ones, and crowded edges.
    const int side = 2 + dice.Below(3);
    const int vertices = 3 + dice.Below(20);
    const int faces = 1 + dice.Below(60);
    TriangleMesh mesh;
    for (int i = 0; i < vertices; ++i) {
      mesh.positions.emplace_back(dice.Below(side), dice.Below(side), dice.Below(side));
    }
    for (int i = 0; i < faces; ++i) {
      mesh.faces.emplace_back(dice.Below(vertices), dice.Below(vertices), dice.Below(vertices));
    }
    ExpectRepairedOrEmpty(mesh, {});
    ExpectRepairedOrEmpty(mesh, {.weld_tolerance = 1.0});
    if (HasFailure()) return;
  }
}

TEST(RepairSoup, DamagedShapesGiveManifolds) {
  const TriangleMesh shapes[] = {shapes::Icosphere(1), shapes::Torus(1.0, 0.4, 8, 6),
                                 shapes::MoebiusStrip(10, 3), shapes::PlaneGrid(1.0, 1.0, 5, 5)};
  for (std::uint32_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    TriangleMesh mesh = shapes[dice.Below(4)];
    for (int damage = dice.Below(12); damage >= 0; --damage) {
      const int f = dice.Below(static_cast<int>(mesh.faces.size()));
      const int v = dice.Below(static_cast<int>(mesh.positions.size()));
      Eigen::Vector3i& face = mesh.faces[f];
      switch (dice.Below(8)) {
        case 0:  // Turned over.
          std::swap(face[0], face[1]);
          break;
        case 1:  // A corner elsewhere.
          face[dice.Below(3)] = v;
          break;
        case 2:  // A hole.
          face = mesh.faces.back();
          mesh.faces.pop_back();
          break;
        case 3:  // A fin.
          mesh.faces.emplace_back(face[0], face[1], v);
          break;
        case 4:  // Two vertices at one place.
          mesh.positions[v] = mesh.positions[face[0]];
          break;
        case 5: {  // A sliver on an edge, and perhaps what it closes.
          const auto c = static_cast<std::int32_t>(mesh.positions.size());
          mesh.positions.push_back(0.5 * (mesh.positions[face[0]] + mesh.positions[face[1]]));
          const Eigen::Vector3i old = face;
          if (dice.Below(2) == 0) {
            face = Eigen::Vector3i(old[0], c, old[2]);
            mesh.faces.emplace_back(c, old[1], old[2]);
          }
          mesh.faces.emplace_back(old[0], old[1], c);
          break;
        }
        case 6:  // A vertex of its own for a corner.
          mesh.positions.push_back(mesh.positions[face[1]]);
          face[1] = static_cast<std::int32_t>(mesh.positions.size()) - 1;
          break;
        default:  // A second face.
          mesh.faces.push_back(Eigen::Vector3i(face));
          break;
      }
      if (mesh.faces.size() < 2) break;
    }
    ExpectRepairedOrEmpty(mesh, {});
    ExpectRepairedOrEmpty(mesh, {.weld_tolerance = 0.05});
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace ccst
