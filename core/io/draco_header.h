#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/byte_source.h"
#include "core/io/mesh_limits.h"

namespace ccst::io {

enum class DracoMethod { kSequential, kEdgebreaker };

/// What a Draco mesh stream says about itself before the first entropy-coded byte. Field names
/// follow the bitstream specification.
struct DracoHeader {
  int version_major = 0;
  int version_minor = 0;
  DracoMethod method = DracoMethod::kSequential;
  bool has_metadata = false;
  std::int64_t faces = 0;
  std::int64_t points = 0;  ///< Sequential: points. Edgebreaker: vertices, at most the points.
  std::size_t counts_offset = 0;  ///< Of the byte where the counts start.
  std::size_t data_offset = 0;    ///< Of the byte after the fields below.

  // Sequential.
  bool compressed_indices = false;

  // Edgebreaker.
  int traversal = 0;  ///< 0 standard, 1 predictive, 2 valence.
  std::int64_t attribute_connectivities = 0;
  std::int64_t symbols = 0;
  std::int64_t split_symbols = 0;
};

/// Reads the header, passes over the metadata and reads the counts. Allocates a few kB.
/// @errors INVALID_ARGUMENT DRACO_DECODE_FAILED, with the byte; says so of point clouds
///       | those of `source`
absl::StatusOr<DracoHeader> ReadDracoHeader(const ByteSource& source);
absl::StatusOr<DracoHeader> ReadDracoHeader(std::span<const char> bytes);

/// Refuses a stream of `size` bytes whose counts are over the limits, contradict each other, or
/// cannot be held by the bytes that follow.
///
/// Some bounds are exact: a raw index takes as many bytes as the number of points asks for; the
/// standard Edgebreaker traversal takes a bit a symbol, and there are at most 4/3 faces a symbol;
/// the decoder itself wants 3 bytes a face of a sequential stream, and no more points than
/// corners. The other methods
/// code a constant run in no bits at all, so that no count is impossible; for them what the
/// decoder would allocate is bounded by DracoMemoryBudget.
/// @errors INVALID_ARGUMENT  DRACO_DECODE_FAILED | LIMIT_EXCEEDED | MESH_EMPTY
absl::Status CheckDracoCounts(const DracoHeader& header, std::size_t size,
                              const MeshLimits& limits);

/// What decoding a stream of `size` bytes may allocate. Regular grids and strips, which compress
/// best of all meshes of use, stay under a hundred faces a byte, or 10 kB.
std::int64_t DracoMemoryBudget(std::size_t size, const MeshLimits& limits);

/// Refuses what needs more than DracoMemoryBudget.
/// @param what  for the message, for example `2 attributes`
absl::Status CheckDracoMemory(std::int64_t needed, std::size_t size, const MeshLimits& limits,
                              const std::string& what);

}  // namespace ccst::io
