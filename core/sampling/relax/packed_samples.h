#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/parallel/parallel.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/mesh/sample_mesh.h"
#include "core/sampling/mesh/samples.h"
#include "core/sampling/relax/ring.h"
#include "core/sampling/relax/ring_batch.h"
#include "core/sampling/relax/snapshot.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// The samples and their mesh while they are relaxed, and beside them copies of what every visit
/// reads, packed so that each is in one line of the cache: places, normals and small rings.
/// Whatever changes the samples or the mesh does so through this class, which keeps the copies in
/// step; others see both as constants.
///
/// Different threads may move different samples, learn their rings, and flip edges of different
/// samples at the same time, as long as nobody reads what another one writes.
class PackedSamples {
 public:
  /// @param with_triangles  rings name their triangles too, which takes 32 bytes a sample more.
  /// Nothing is owned. About 96 bytes a sample. Cost O(n).
  PackedSamples(const Surface* surface, bool with_triangles, SampleMesh* mesh, Samples* samples);

  PackedSamples(const PackedSamples&) = delete;
  PackedSamples& operator=(const PackedSamples&) = delete;

  const SampleMesh& mesh() const { return mesh_; }
  const Samples& samples() const { return samples_; }

  /// N.
  const std::vector<RingPlace>& places() const { return places_; }
  /// N.
  const std::vector<RingNormal>& normals() const { return normals_; }
  /// N, of which those are right for which LearnRing() returns true.
  const std::vector<SmallRing>& rings() const { return rings_; }
  /// N like rings(): the triangles from each neighbour to the next; empty without them.
  const std::vector<SmallRing>& triangles() const { return triangles_; }
  /// N like rings(): how many neighbours there are.
  const std::vector<std::uint8_t>& valences() const { return valences_; }

  /// Looks up the neighbours of `v` unless they are known. @return whether they are a SmallRing, as
  /// those of a sample that moves freely and has at most SmallRing::kMost of them are.
  bool LearnRing(std::int32_t v) {
    if (valences_[v] == kUnknown) valences_[v] = FindRing(v);
    return valences_[v] != kNoSmallRing;
  }

  /// Moves `v` to `point`, where the surface has this normal.
  void Move(std::int32_t v, const SurfacePoint& point, const Eigen::Vector3d& normal) {
    samples_.position[v] = point.position;
    samples_.face[v] = point.face;
    samples_.weights[v] = point.weights;
    samples_.normal[v] = normal;
    PackPlace(v);
  }
  /// The same on its boundary loop or crease, to this arc length along it.
  void MoveAlong(std::int32_t v, double arc, const SurfacePoint& point,
                 const Eigen::Vector3d& normal) {
    Move(v, point, normal);
    samples_.arc[v] = arc;
  }

  /// Flips of the mesh after which the rings concerned are looked up anew. Must not outlive this.
  EdgeFlips MakeFlips() {
    return EdgeFlips(&mesh_, &samples_.position, &samples_.normal, valences_.data());
  }

  /// Merges the origin of half-edge `h` into its target; it has no edges then.
  /// @pre mesh().CanCollapse(h).
  void Collapse(std::int32_t h);

  /// Puts `v`, which has no edges, at `point` and into triangle `t`.
  /// @param slots  two dead triangles to use.
  void Insert(std::int32_t v, const SurfacePoint& point, TriangleIndex t,
              const std::array<TriangleIndex, 2>& slots);

  /// Goes back to `snapshot`, which is empty then. Cost O(n).
  void Restore(Snapshot* snapshot, const Parallel& parallel);

  /// Passes keep normals in single precision; from here on they are those of the surface. Cost
  /// O(n).
  void RefineNormals(const Parallel& parallel);

 private:
  // In valences_: nothing is known of the ring; it is no SmallRing.
  static constexpr std::uint8_t kUnknown = 0;
  static constexpr std::uint8_t kNoSmallRing = 255;

  void PackPlace(std::int32_t v) {
    const Eigen::Vector3d& position = samples_.position[v];
    const Eigen::Vector3f normal = samples_.normal[v].cast<float>();
    places_[v] = {position[0], position[1], position[2], 0.0};
    normals_[v] = {normal[0], normal[1], normal[2], 0.0F};
  }
  std::uint8_t FindRing(std::int32_t v);
  // Those of `v` and of its neighbours.
  void ForgetRingsAround(std::int32_t v);

  const Surface& surface_;
  SampleMesh& mesh_;
  Samples& samples_;
  std::vector<RingPlace> places_;
  std::vector<RingNormal> normals_;
  std::vector<SmallRing> rings_;
  std::vector<SmallRing> triangles_;
  std::vector<std::uint8_t> valences_;
};

/// In what the copies differ from the samples and their mesh, for assertions and tests; empty when
/// in nothing. Cost O(n).
std::string FindFault(const PackedSamples& packed);

}  // namespace ccst::internal
