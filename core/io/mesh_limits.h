#pragma once

#include <cstdint>

namespace ccst {

/// What a reader accepts. Checked against the announced counts before anything of that size
/// is allocated, and against the counts that were really read.
struct MeshLimits {
  std::int64_t max_vertices = 10'000'000;
  std::int64_t max_faces = 20'000'000;  ///< Triangles, after polygons are cut.
  /// What a Draco decoder may allocate, estimated from the announced counts; also what the
  /// attributes of a glTF file may take.
  std::int64_t max_decoded_bytes = std::int64_t{2} << 30;
  std::int64_t min_faces = 1;                      ///< 0: points alone will do.
  std::int64_t max_bytes = std::int64_t{2} << 30;  ///< Encoded size.
};

}  // namespace ccst
