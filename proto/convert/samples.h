#pragma once

#include <cstdint>
#include <span>

#include "absl/status/status.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/sampling/sampling.h"

namespace ccst {

/// Most bytes of a message of a stream, encoded: what a reader who takes its time makes the server
/// keep.
inline constexpr std::int64_t kMaxChunkBytes = std::int64_t{256} << 10;

/// Most samples in a `SampleChunk` and triangles in a `SampleMeshChunk`, within kMaxChunkBytes.
inline constexpr std::int64_t kMaxChunkLength = 4096;

/// Most samples with such attributes that a chunk holds within kMaxChunkBytes: kMaxChunkLength, or
/// fewer where there are many.
std::int64_t SamplesPerChunk(std::span<const Attribute> attributes);

/// Samples [start, start + count) of `samples`, which must hold them.
v1::SampleChunk SampleChunkToProto(const SampleSet& samples, std::int64_t start,
                                   std::int64_t count);

/// Triangles [start, start + count) of `samples`, which must hold them.
v1::SampleMeshChunk SampleMeshChunkToProto(const SampleSet& samples, std::int64_t start,
                                           std::int64_t count);

/// Appends the chunk to `samples`. Positions and normals have the precision of floats; faces and
/// barycentrics are exact, attributes too, whatever their values are.
/// @errors INTERNAL when the chunk does not start where `samples` ends, its arrays do not fit
///         each other, its attributes are not those of the chunks before, or a triangle names a
///         sample not in `samples`; nothing is appended then.
absl::Status AppendChunk(const v1::SampleChunk& chunk, SampleSet& samples);
absl::Status AppendChunk(const v1::SampleMeshChunk& chunk, SampleSet& samples);

}  // namespace ccst
