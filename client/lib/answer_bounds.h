#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/sampling/sampling.h"

namespace ccst {

/// How much of one answer is kept: a server that sends on and on, by mistake or on purpose, must
/// not fill its caller's memory.
struct AnswerBounds {
  std::int64_t samples = 0;
  std::int64_t triangles = 0;
  std::int64_t attribute_values = 0;  ///< Of all attributes of all samples together.
};

/// Of a job that the caller asked for: the samples, their triangles, and values of the attributes
/// that the mesh has.
AnswerBounds BoundsOf(const SamplingOptions& options, const TriangleMesh& mesh);

/// Of a job that the server announces: as many samples and triangles as it says.
/// @errors DATA_LOSS  it announces what no job can have, or other than it was asked for
absl::Status BoundsOf(const v1::Job& job, AnswerBounds& bounds);

/// Append a chunk to `samples`, as AppendChunk() of proto/convert does.
/// @errors DATA_LOSS  the chunk does not follow or contradicts itself, or `bounds` would be passed;
///         `samples` stay as they were
absl::Status AppendWithin(const AnswerBounds& bounds, const v1::SampleChunk& chunk,
                          SampleSet& samples);
absl::Status AppendWithin(const AnswerBounds& bounds, const v1::SampleMeshChunk& chunk,
                          SampleSet& samples);

/// The pages of a list: bounds what they hold together and finds those that lead nowhere.
class ListBounds {
 public:
  /// `page_size` records are asked for at a time.
  explicit ListBounds(int page_size) : page_size_(page_size) {}

  /// Counts a page of `records` in a message of `bytes`.
  /// @param asked  the token the page was asked for with
  /// @param next   the token of the page after it; empty after the last one
  /// @errors DATA_LOSS  more records than asked for, a page that leads to itself
  ///       | RESOURCE_EXHAUSTED LIMIT_EXCEEDED  the list is longer than anybody could read
  absl::Status Take(int records, std::size_t bytes, const std::string& asked,
                    const std::string& next);

 private:
  const int page_size_;
  std::int64_t left_ = std::int64_t{256} << 20;  // Bytes, of messages and of what holds them.
};

}  // namespace ccst
