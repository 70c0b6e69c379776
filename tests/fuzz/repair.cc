// Repair() of any triangle list: an oriented manifold or a refusal. And a job on it: samples or a
// refusal.
//
// Layout of an input: a byte of flags, whose upper five bits tell what is asked of the job, a byte
// of tolerance, a byte V, then V positions, then faces of three bytes. Positions are three bytes on
// a coarse grid, which makes many coincide; with flag 1 they are three doubles, of any bits.
#include "core/repair/repair.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/quality/mesh_topology.h"
#include "core/surface/surface.h"
#include "tests/fuzz/sample_few.h"
#include "tests/fuzz/target.h"

namespace {

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  std::size_t left() const { return left_; }

  /// Zeros past the end.
  template <typename T>
  T Take() {
    T value{};
    const std::size_t count = left_ < sizeof(T) ? left_ : sizeof(T);
    if (count > 0) std::memcpy(&value, data_, count);
    data_ += count;
    left_ -= count;
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const auto flags = bytes.Take<std::uint8_t>();
  ccst::RepairOptions options;
  options.weld_tolerance = (flags & 2) != 0 ? bytes.Take<std::uint8_t>() / 64.0 : 0.0;
  const int count = bytes.Take<std::uint8_t>();
  ccst::TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d& p = mesh.positions.emplace_back();
    for (int k = 0; k < 3; ++k) {
      p[k] = (flags & 1) != 0 ? bytes.Take<double>() : bytes.Take<std::int8_t>() / 8;
    }
  }
  while (bytes.left() >= 3) {
    // Not all faces out of range are worth a run.
    const int limit = count + ((flags & 4) != 0 ? 1 : 0);
    Eigen::Vector3i& face = mesh.faces.emplace_back();
    for (int k = 0; k < 3; ++k) face[k] = bytes.Take<std::uint8_t>() % (limit > 0 ? limit : 1);
  }
  SampleFew(mesh, (flags >> 3) * 977U + static_cast<std::uint32_t>(mesh.faces.size()));
  const auto repaired = ccst::Repair(mesh, options);
  if (!repaired.ok()) return 0;
  const auto vertices = static_cast<std::int64_t>(repaired->mesh.positions.size());
  if (!ccst::quality::MeasureTopology(vertices, repaired->mesh.faces).IsManifold()) std::abort();
  if (repaired->source_face.size() != repaired->mesh.faces.size()) std::abort();
  if (repaired->source_corner.size() != repaired->mesh.faces.size()) std::abort();
  if (!ccst::Surface::Build(repaired->mesh).ok()) std::abort();
  return 0;
}
