#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/byte_source.h"
#include "core/io/draco_header.h"
#include "core/io/mesh_limits.h"

namespace ccst::io {

/// One attribute of a Draco stream as its table lists it.
struct DracoListedAttribute {
  int type = 0;              ///< A draco::GeometryAttribute::Type.
  int components = 0;        ///< 1 to 255.
  int number_bytes = 0;      ///< Of one component.
  bool as_integers = false;  ///< Decoded by way of integers of 32 bits.
  bool has_seams = false;    ///< The corners of a vertex may have different values.
};

/// What a Draco stream says of itself before the first value of an attribute.
struct DracoAnnouncement {
  DracoHeader header;
  std::vector<DracoListedAttribute> attributes;
  /// Points that the attributes may have: where they have seams as many as there are corners.
  std::int64_t most_points = 0;
};

/// Reads header, counts and the table of attributes. The table lies behind the connectivity, which
/// is passed over: it is not decoded, and of its bytes only the tables are read, except for the
/// bit lengths of indices that have lengths of their own. Cost O(faces) at worst and O(1) mostly;
/// memory a few kB, and at worst a byte a face.
/// @errors INVALID_ARGUMENT  DRACO_DECODE_FAILED; those of CheckDracoCounts()
///       | those of `source`
absl::StatusOr<DracoAnnouncement> ReadDracoAnnouncement(const ByteSource& source,
                                                        const MeshLimits& limits);

/// What decoding takes.
struct DracoMemory {
  std::int64_t decoder_bytes = 0;  ///< Draco's own, until the mesh is made.
  std::int64_t mesh_bytes = 0;     ///< The TriangleMesh.
  std::int64_t sample_bytes = 0;   ///< Values of attributes that every sample carries.

  std::int64_t total() const { return decoder_bytes + mesh_bytes; }
};
DracoMemory MemoryOf(const DracoAnnouncement& announced);

}  // namespace ccst::io
