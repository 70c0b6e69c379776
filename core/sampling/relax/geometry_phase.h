#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/parallel/parallel.h"
#include "core/sampling/energy.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/relax/capacity_sums.h"
#include "core/sampling/relax/packed_samples.h"
#include "core/sampling/relax/ring.h"
#include "core/sampling/relax/ring_batch.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// The geometry phase: moves samples over the surface, one after the other with the rest kept
/// fixed, to make the sample triangles' capacities equal.
///
/// A vertex s moves on its osculating torus, to second order s + u T1 + v T2 + II(u, v) / 2 N with
/// the second fundamental form II of the surface; in curvatures and arc lengths this has no
/// singularity where the surface is flat. The ring's energy sum_t (c_t - 1)^2, c_t = C_t / C*, is
/// minimised in (u, v) by one Newton step on a convex majoriser (core/docs/algorithm.md), made
/// longer by a constant factor; the point is then put back on the surface by following its host.
/// A move is kept only if the ring's energy does not grow and no triangle turns over; otherwise
/// the step is halved, a few times. The energy therefore never rises.
/// Source: Xu et al. 2012, sections 3.3, 3.4 and appendices A, B, with the errata.
class GeometryPhase {
 public:
  /// @param mesh, samples  from now on changed through packed() alone.
  /// @param parallel   threads to work on; like the others not owned.
  /// @param interrupt  may be null; once requested, densities count as 1 until they are updated.
  GeometryPhase(const Surface* surface, const Density* density, const Plan* plan, Energy energy,
                SampleMesh* mesh, Samples* samples, const Parallel* parallel,
                Interrupt* interrupt = nullptr);

  /// Visits every active vertex once. A vertex is active when it or a neighbour moved by more than
  /// a small part of the spacing since its last visit, or when Activate() named it.
  /// Vertices are visited block by block of consecutive indices, which are near each other. Blocks
  /// run side by side: a vertex whose neighbours are all of its block sees and changes nothing of
  /// the others. The rest, between the blocks, comes after them, in blocks of several, until one
  /// holds all. In a block, eight vertices at a time are visited that are not neighbours. So the
  /// order, and with it every bit, depends on the samples alone.
  /// Ends early, every vertex either moved or not, when `interrupt` is requested.
  /// @return the largest move in units of the local spacing. Cost O(active vertices).
  double Pass(Interrupt* interrupt) { return Sweep(1, /*flip=*/false, interrupt).largest_move; }

  struct Change {
    double largest_move = 0.0;  ///< [local spacing]
    std::int64_t flips = 0;
  };
  /// `passes` times a pass and the flips of what it spoilt: an alternation. Each block does all of
  /// its own before the next, while its samples are in the caches.
  Change Alternate(int passes, Interrupt* interrupt) {
    return Sweep(passes, /*flip=*/true, interrupt);
  }

  /// Integrates the density anew over the triangles around the vertices that moved since the last
  /// call or that Activate() named, and activates the corners of those it changed. Between calls a
  /// triangle's mean density is fixed, so that the energy falls with every move.
  /// Does nothing where the density is uniform. When `interrupt` was requested, the rest follows
  /// with the next call. Cost O(such triangles).
  void UpdateDensities(Interrupt* interrupt);

  /// Goes back to `snapshot`, which is empty then, and integrates all densities anew.
  void Restore(Snapshot* snapshot, Interrupt* interrupt);

  /// The samples and their mesh. Whoever changes them activates what has changed.
  PackedSamples& packed() { return packed_; }

  /// Marks `v`, whose triangles have changed, and its neighbours for the next pass.
  void Activate(std::int32_t v);
  /// The same for one of the corners of triangles that were flipped, all of which are to be named.
  void ActivateFlipped(std::int32_t v);
  void DeactivateAll();

  /// Half-edges that were not locally Delaunay when the last pass left one of their ends; may
  /// repeat. An edge spoilt by a later move is found when its own end is visited next.
  const std::vector<std::int32_t>& spoilt_edges() const { return spoilt_edges_; }

  /// Vertices that moved, or whose triangles Alternate() flipped, since the last call of
  /// ClearMoved().
  const std::vector<std::uint8_t>& moved() const { return moved_; }
  void ClearMoved();

  /// c_t = C_t / C* of triangle `t`.
  double Capacity(TriangleIndex t) const;
  /// How the capacities c_t are spread.
  struct Spread {
    double energy = 0.0;  ///< Mean of (c_t - 1)^2, or of c_t^2 for Energy::kSquaredArea.
    double cv = 0.0;      ///< Standard deviation over mean.
  };
  Spread MeasureCapacities() const;
  /// The same in single precision for each triangle, 6e-8 of the energy and the variation off, in
  /// two thirds of the time: what alternations are judged by.
  Spread EstimateCapacities() const;

  /// Largest move that still counts as rest, in units of the local spacing.
  double rest = 0.006;
  /// Factor on the Newton step.
  double stretch = 1.5;

 private:
  /// Longest step in units of the local spacing.
  static constexpr double kLongestStep = 0.5;
  /// Shortest Newton step that is made, in units of what counts as rest: far below it, however it
  /// would end.
  static constexpr double kLeastStep = 0.1;

  // Consecutive vertices and what a sweep over them takes and leaves.
  struct Block {
    Block(std::int32_t first_vertex, std::int32_t end_vertex, EdgeFlips own_flips)
        : first(first_vertex), end(end_vertex), flips(std::move(own_flips)) {
      flips.Restrict(first, end);
    }

    std::int32_t first;
    std::int32_t end;
    EdgeFlips flips;
    std::vector<std::int32_t> waiting;       // To be visited, with neighbours in other blocks.
    std::vector<std::int32_t> spoilt_edges;  // That have not been flipped yet.
    Change change;
  };
  // Blocks of more and more samples; the last is one.
  using Levels = std::vector<std::vector<Block>>;
  // @param shifted  blocks begin in the middle of those that are not.
  Levels MakeLevels(bool shifted);
  Change Sweep(int passes, bool flip, Interrupt* interrupt);
  // What a sweep over one block needs in between.
  struct Scratch {
    std::vector<std::int32_t> candidates;  // To be visited, if their neighbours are of the block.
    std::vector<std::int32_t> plain;       // Of these, that can be visited eight at a time.
    Ring ring;
  };
  // What is active of the blocks of the level below that make up block `b`, or of all its vertices.
  void FindCandidates(const Levels& levels, std::size_t level, std::size_t b,
                      std::vector<std::int32_t>* candidates) const;
  void VisitBlock(Block* block, Scratch* scratch, Interrupt* interrupt);
  void FlipBlock(Block* block, Interrupt* interrupt);
  // Eight that have not been found to be neighbours.
  void VisitTogether(Batch* batch, Ring* ring, Block* block);
  void VisitAlone(std::int32_t v, Ring* ring, Block* block);
  // With its ring gathered.
  void Visit(std::int32_t v, Ring* ring, Block* block);
  // What follows from a move by `relative` local spacings of `v` among `neighbours`.
  void NoteMove(std::int32_t v, double relative, const std::int32_t* neighbours, int count,
                Block* block);
  // Names the ring of `v` and its densities. @return false for a point and for more than fit.
  bool Gather(std::int32_t v, Ring* ring) const;
  // Of equilateral triangles of the target capacity, where the density is uniform.
  double RegularSpacing(std::int32_t component) const;
  double MoveInterior(std::int32_t v, Ring* ring, RingAngles* angles);
  double MoveAlong(std::int32_t v, Ring* ring, RingAngles* angles);
  /// True when moving the vertex by `step` lowers its ring's energy and turns no triangle over.
  bool Improves(const Ring& ring, const RingSums& before, const Eigen::Vector3d& step,
                const Eigen::Vector3d& normal, RingAngles* angles) const;

  // Appends the half-edges from `v` to some of its neighbours, named in their order.
  void AddSpokes(std::int32_t v, const int* spokes, int count,
                 std::vector<std::int32_t>* half_edges) const;
  double MeanDensity(TriangleIndex t) const;
  // Of the sums over all triangles, which `sum(first, end)` gives for some of them.
  Spread SpreadOf(const std::function<CapacitySums(std::int32_t, std::int32_t)>& sum) const;

  const Surface& surface_;
  const Density& density_;
  const Plan& plan_;
  const Energy energy_;
  const Parallel& parallel_;
  PackedSamples packed_;
  const SampleMesh& mesh_;  // Of packed_, like the next.
  const Samples& samples_;
  const Registers registers_ = WidestRegisters();
  std::vector<double> scale_;  // Per component: 1 / C*.
  std::vector<HostVertex> hosts_;
  // In turn, so that what lies between blocks is not always the same.
  std::array<Levels, 2> levels_;
  std::size_t sweeps_ = 0;
  std::vector<std::int32_t> spoilt_edges_;
  std::vector<std::uint8_t> active_;
  std::vector<std::uint8_t> moved_;
  std::vector<float> mean_density_;        // Per triangle; empty where the density is uniform.
  std::vector<std::uint8_t> is_outdated_;  // Per vertex: mean_density_ of its triangles is.
};

}  // namespace ccst::internal
