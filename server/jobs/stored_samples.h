#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/sampling/sampling.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// Writes samples as a blob: a header, then one array after the other, little endian, so that any
/// range of samples is a few reads. Positions and normals have the precision of floats, as on the
/// wire; faces, barycentrics, triangles and attributes are exact. The layout is in
/// server/docs/stored-samples.md. Errors as BlobWriter.
absl::Status WriteSamples(const SampleSet& samples, BlobWriter& writer);

/// Samples in a blob, read in pieces: holds no more memory than the piece. Thread-safe.
class StoredSamples {
 public:
  /// Reads the header.
  /// @errors INTERNAL STORAGE_FAILED it is not one, or the blob is too short for it
  static absl::StatusOr<StoredSamples> Open(std::shared_ptr<const Blob> blob);

  std::int64_t sample_count() const { return sample_count_; }
  std::int64_t triangle_count() const { return triangle_count_; }
  /// The attributes that samples carry, without values.
  const std::vector<Attribute>& attributes() const { return attributes_; }

  /// Samples [start, start + count), which must be inside; no triangles.
  absl::StatusOr<SampleSet> ReadSamples(std::int64_t start, std::int64_t count) const;
  /// Triangles [start, start + count), which must be inside; nothing else.
  absl::StatusOr<SampleSet> ReadTriangles(std::int64_t start, std::int64_t count) const;

 private:
  StoredSamples() = default;

  // Where the arrays start.
  struct Offsets {
    std::int64_t faces = 0;
    std::int64_t barycentrics = 0;
    std::int64_t positions = 0;
    std::int64_t normals = 0;
    std::vector<std::int64_t> attributes;
    std::int64_t triangles = 0;
    std::int64_t end = 0;
  };

  std::shared_ptr<const Blob> blob_;
  std::int64_t sample_count_ = 0;
  std::int64_t triangle_count_ = 0;
  std::vector<Attribute> attributes_;
  Offsets offsets_;
};

}  // namespace ccst::server
