#include "server/rpc/sample_chunks.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/samples.h"

namespace ccst::server {

SampleChunks::SampleChunks(StoredSamples stored, std::int64_t next_sample,
                           std::int64_t next_triangle)
    : stored_(std::move(stored)), next_sample_(next_sample), next_triangle_(next_triangle) {}

absl::Status SampleChunks::NextSamples(v1::SampleChunk& chunk) {
  const std::int64_t count =
      std::min(SamplesPerChunk(stored_.attributes()), stored_.sample_count() - next_sample_);
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples, stored_.ReadSamples(next_sample_, count));
  chunk = SampleChunkToProto(samples, 0, count);
  chunk.set_start_index(next_sample_);
  next_sample_ += count;
  return absl::OkStatus();
}

absl::Status SampleChunks::NextTriangles(v1::SampleMeshChunk& chunk) {
  const std::int64_t count = std::min(kMaxChunkLength, stored_.triangle_count() - next_triangle_);
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples, stored_.ReadTriangles(next_triangle_, count));
  chunk = SampleMeshChunkToProto(samples, 0, count);
  chunk.set_start_index(next_triangle_);
  next_triangle_ += count;
  return absl::OkStatus();
}

}  // namespace ccst::server
