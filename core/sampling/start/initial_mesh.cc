#include "core/sampling/start/initial_mesh.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/assert.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/mesh/faults.h"
#include "core/sampling/start/insertion.h"
#include "core/sampling/start/thinning.h"
#include "core/sampling/start/vertex_removal.h"

namespace ccst::internal {
namespace {

/// Vertices of the surface in a block that is thinned by itself: as many blocks as keep several
/// threads busy, but none so small that most of its vertices lie at its border. Of the number of
/// vertices alone, for the order of removals follows from it.
constexpr std::int32_t kBlocks = 64;
constexpr std::int32_t kLeastBlock = 2048;
/// What was at a border is done in blocks this many times as large, and at last in one.
constexpr std::int32_t kGrowth = 8;

/// Per vertex the block it lies in, each with `size` vertices of the surface that follow each other
/// in memory, so in space, and the samples there.
std::vector<std::int32_t> Blocks(const Surface& surface, const Samples& samples,
                                 std::size_t vertex_count, std::int32_t size) {
  std::vector<std::int32_t> blocks;
  blocks.reserve(vertex_count);
  for (const std::int32_t face : samples.face) blocks.push_back(surface.faces()[face][0] / size);
  for (std::int32_t v = 0; v < surface.vertex_count(); ++v) blocks.push_back(v / size);
  blocks.resize(vertex_count, 0);
  return blocks;
}

/// The live triangles over the samples for whose vertices `wanted` holds, ordered by their smallest
/// vertex, as a mesh of `vertex_count` vertices. Unfinished when `interrupt` was requested.
template <typename Wanted>
SampleMesh Compact(const SampleMesh& mesh, std::int32_t vertex_count, const Wanted& wanted,
                   Interrupt* interrupt) {
  const auto is_live = [&](std::int32_t t) {
    return !mesh.IsDead(TriangleIndex(t)) && wanted(mesh.origin[3 * t]);
  };
  const auto first_corner = [&](std::int32_t t) {
    const std::int32_t* corner = &mesh.origin[3 * t];
    return corner[0] < corner[1] ? (corner[0] < corner[2] ? 0 : 2)
                                 : (corner[1] < corner[2] ? 1 : 2);
  };
  std::vector<std::int32_t> start(vertex_count + 1, 0);
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (interrupt->RequestedAt(t)) return {};
    if (is_live(t)) ++start[mesh.origin[3 * t + first_corner(t)] + 1];
  }
  for (std::int32_t v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  std::vector<std::int32_t> sources(3 * static_cast<std::size_t>(start[vertex_count]));
  std::vector<std::int32_t> number(mesh.origin.size(), -1);  // Half-edge before -> now.
  for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (interrupt->RequestedAt(t)) return {};
    if (!is_live(t)) continue;
    const int first = first_corner(t);
    const std::int32_t place = start[mesh.origin[3 * t + first]]++;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t h = 3 * t + (first + k) % 3;
      sources[3 * place + k] = h;
      number[h] = 3 * place + k;
    }
  }
  SampleMesh result;
  result.origin.reserve(sources.size());
  result.twin.reserve(sources.size());
  for (const std::int32_t h : sources) {
    if (interrupt->RequestedAfter(1)) return {};
    result.origin.push_back(mesh.origin[h]);
    result.twin.push_back(mesh.twin[h] < 0 ? -1 : number[mesh.twin[h]]);
    if (!mesh.locked.empty()) result.locked.push_back(mesh.locked[h]);
  }
  result.outgoing.reserve(vertex_count);
  for (std::int32_t v = 0; v < vertex_count; ++v) {
    result.outgoing.push_back(mesh.outgoing[v] < 0 ? -1 : number[mesh.outgoing[v]]);
  }
  return result;
}

}  // namespace

absl::StatusOr<SampleMesh> BuildInitialMesh(const Surface& surface, const Plan& plan,
                                            const Samples& samples, Interrupt* interrupt,
                                            std::vector<std::int32_t>* failed,
                                            const Parallel& parallel) {
  const auto stopped = [&] { return interrupt->Error("the first triangulation was built"); };
  InsertedSamples insertion = InsertSamples(surface, plan, samples, parallel, interrupt);
  if (interrupt->Requested()) return stopped();
  const auto thin = [&](std::int32_t size) {
    ThinBlocks(samples.count(), Blocks(surface, samples, insertion.positions.size(), size),
               insertion.positions, insertion.normals, parallel, interrupt, &insertion.mesh);
  };
  const std::int32_t count = surface.vertex_count();
  for (std::int32_t size = std::max(kLeastBlock, count / kBlocks); size < count;) {
    thin(size);
    size = size < count / kGrowth ? kGrowth * size : count;
  }
  thin(count);
  CCST_ASSERT_NO_FAULT(FindFault(insertion.mesh));
  CCST_ASSIGN_OR_RETURN(const std::vector<std::int32_t> left,
                        RemoveVertices(samples.count(), insertion.positions, insertion.normals,
                                       interrupt, &insertion.mesh));
  CCST_ASSERT_NO_FAULT(FindFault(insertion.mesh));
  if (!left.empty() && failed == nullptr) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
                     absl::StrCat("sample_count ", samples.count(),
                                  " is too small for the topology of the surface"));
  }
  std::vector<std::uint8_t> wanted(plan.components.size(), 1);
  for (const std::int32_t v : left) {
    const std::int32_t c = insertion.components[v];
    if (std::exchange(wanted[c], 0)) failed->push_back(c);
  }
  if (interrupt->Requested()) return stopped();
  SampleMesh mesh = Compact(
      insertion.mesh, samples.count(),
      [&](std::int32_t v) { return wanted[insertion.components[v]] != 0; }, interrupt);
  if (interrupt->Requested()) return stopped();
  EdgeFlips(&mesh, &samples.position, &samples.normal).FlipAll(interrupt);
  if (interrupt->Requested()) return stopped();
  return mesh;
}

}  // namespace ccst::internal
