#pragma once

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "ccst/v1/sampling_service.pb.h"
#include "server/jobs/stored_samples.h"

namespace ccst::server {

/// Cuts stored samples into chunks for streams: a cursor that holds no sample. Not thread-safe.
class SampleChunks {
 public:
  /// From sample `next_sample` and triangle `next_triangle` on.
  SampleChunks(StoredSamples stored, std::int64_t next_sample, std::int64_t next_triangle);

  bool has_sample() const { return next_sample_ < stored_.sample_count(); }
  bool has_triangle() const { return next_triangle_ < stored_.triangle_count(); }

  /// The next samples or triangles, of which there are some left. Errors as StoredSamples.
  absl::Status NextSamples(v1::SampleChunk& chunk);
  absl::Status NextTriangles(v1::SampleMeshChunk& chunk);

  std::int64_t next_sample() const { return next_sample_; }

 private:
  StoredSamples stored_;
  std::int64_t next_sample_;
  std::int64_t next_triangle_;
};

}  // namespace ccst::server
