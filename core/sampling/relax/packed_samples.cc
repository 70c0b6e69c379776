#include "core/sampling/relax/packed_samples.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace ccst::internal {
namespace {

/// Samples that one thread packs in one go.
constexpr std::int64_t kPackedAtOnce = 8192;

/// Calls `each(v)` for every sample, on several threads.
template <typename Each>
void ForEachSample(const Samples& samples, const Parallel& parallel, const Each& each) {
  parallel.ForRanges(samples.count(), kPackedAtOnce, [&](std::int64_t first, std::int64_t end) {
    for (std::int64_t v = first; v < end; ++v) each(static_cast<std::int32_t>(v));
  });
}

/// Whether `ring` are the targets of the half-edges that leave `v`, and `triangles`, unless it is
/// null, theirs.
bool IsRingOf(const SampleMesh& mesh, std::int32_t v, const SmallRing& ring,
              const SmallRing* triangles, int valence) {
  int at = 0;
  bool agrees = true;
  mesh.ForEachOutgoing(v, [&](std::int32_t h) {
    agrees = agrees && at < valence && ring.vertex[at] == mesh.Target(h) &&
             (triangles == nullptr || triangles->vertex[at] == h / 3);
    ++at;
  });
  return agrees && at == valence;
}

}  // namespace

PackedSamples::PackedSamples(const Surface* surface, bool with_triangles, SampleMesh* mesh,
                             Samples* samples)
    : surface_(*surface),
      mesh_(*mesh),
      samples_(*samples),
      places_(samples->count()),
      normals_(samples->count()),
      rings_(samples->count()),
      triangles_(with_triangles ? samples->count() : 0),
      valences_(samples->count(), kUnknown) {
  for (std::int32_t v = 0; v < samples->count(); ++v) PackPlace(v);
}

std::uint8_t PackedSamples::FindRing(std::int32_t v) {
  const std::int32_t start = mesh_.outgoing[v];
  if (samples_.kind[v] != SampleMesh::Kind::kInterior || start < 0) return kNoSmallRing;
  SmallRing& ring = rings_[v];
  int count = 0;
  std::int32_t h = start;
  do {
    if (count == SmallRing::kMost) return kNoSmallRing;
    if (!triangles_.empty()) triangles_[v].vertex[count] = h / 3;
    ring.vertex[count++] = mesh_.Target(h);
    h = mesh_.Rotate(h);
  } while (h != start && h >= 0);
  if (h < 0) return kNoSmallRing;
  std::fill(ring.vertex + count, ring.vertex + SmallRing::kMost, ring.vertex[0]);
  if (!triangles_.empty()) {
    std::fill(triangles_[v].vertex + count, triangles_[v].vertex + SmallRing::kMost, start / 3);
  }
  return static_cast<std::uint8_t>(count);
}

void PackedSamples::ForgetRingsAround(std::int32_t v) {
  valences_[v] = kUnknown;
  mesh_.ForEachOutgoing(v, [&](std::int32_t h) {
    valences_[mesh_.Target(h)] = kUnknown;
    valences_[mesh_.Apex(h)] = kUnknown;
  });
}

void PackedSamples::Collapse(std::int32_t h) {
  const std::int32_t v = mesh_.origin[h];
  const std::int32_t w = mesh_.Target(h);
  mesh_.Collapse(h);
  valences_[v] = kUnknown;
  ForgetRingsAround(w);  // The neighbours of `v` are now those of `w`.
}

void PackedSamples::Insert(std::int32_t v, const SurfacePoint& point, TriangleIndex t,
                           const std::array<TriangleIndex, 2>& slots) {
  samples_.Place(v, surface_, point);
  PackPlace(v);
  mesh_.InsertIntoTriangle(v, t, slots[0], slots[1]);
  ForgetRingsAround(v);
}

void PackedSamples::Restore(Snapshot* snapshot, const Parallel& parallel) {
  snapshot->Restore(surface_, parallel, &mesh_, &samples_);
  ForEachSample(samples_, parallel, [&](std::int32_t v) { PackPlace(v); });
  std::fill(valences_.begin(), valences_.end(), kUnknown);
}

void PackedSamples::RefineNormals(const Parallel& parallel) {
  ForEachSample(samples_, parallel, [&](std::int32_t v) {
    samples_.normal[v] = surface_.NormalAt(samples_.face[v], samples_.weights[v]);
    PackPlace(v);
  });
}

std::string FindFault(const PackedSamples& packed) {
  const Samples& samples = packed.samples();
  for (std::int32_t v = 0; v < samples.count(); ++v) {
    const RingPlace& place = packed.places()[v];
    if (samples.position[v] != Eigen::Vector3d(place.x, place.y, place.z)) {
      return absl::StrCat("the packed place of sample ", v, " is not where it is");
    }
    const RingNormal& normal = packed.normals()[v];
    if (samples.normal[v].cast<float>() != Eigen::Vector3f(normal.x, normal.y, normal.z)) {
      return absl::StrCat("the packed normal of sample ", v, " is another than its own");
    }
    const int valence = packed.valences()[v];
    if (valence == 0 || valence > SmallRing::kMost) continue;
    const SmallRing* const triangles =
        packed.triangles().empty() ? nullptr : &packed.triangles()[v];
    if (packed.mesh().outgoing[v] < 0 ||
        !IsRingOf(packed.mesh(), v, packed.rings()[v], triangles, valence)) {
      return absl::StrCat("the packed ring of sample ", v, " is not that of the mesh");
    }
  }
  return "";
}

}  // namespace ccst::internal
