// Draco: the guard before the decoder, the decoder, and a whole job on what it gives. The checksum
// of the bytes tells what is asked for, so that mutations vary it too.
#include <cstdlib>
#include <span>

#include "core/io/draco_mesh.h"
#include "tests/fuzz/sample_few.h"
#include "tests/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Small enough that an input which passes the guard is decoded in no time.
  const ccst::MeshLimits limits = {
      .max_vertices = 100'000, .max_faces = 100'000, .max_decoded_bytes = std::int64_t{64} << 20};
  const auto mesh = ccst::DecodeDraco(std::span(reinterpret_cast<const char*>(data), size), limits);
  if (!mesh.ok()) return 0;
  const auto count = static_cast<std::int64_t>(mesh->positions.size());
  if (mesh->faces.empty()) std::abort();
  for (const Eigen::Vector3i& face : mesh->faces) {
    if (face.minCoeff() < 0 || face.maxCoeff() >= count) std::abort();
  }
  std::uint32_t choice = 0;
  for (std::size_t i = 0; i < size; ++i) choice = 31 * choice + data[i];
  SampleFew(*mesh, choice);
  return 0;
}
