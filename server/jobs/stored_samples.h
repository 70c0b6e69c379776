#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/sampling/sampling.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// Writes samples as a blob: a header, then one array after the other, little endian, so that any
/// range of samples is a few reads, and sums of all that, so that each range can be checked by
/// itself. Positions and normals have the precision of floats, as on the wire; faces, barycentrics,
/// triangles and attributes are exact. The layout is in server/docs/stored-samples.md. Errors as
/// BlobWriter.
absl::Status WriteSamples(const SampleSet& samples, BlobWriter& writer);

/// What so many samples and their triangles take on the disk [bytes], about: 68 each without
/// attributes.
inline std::int64_t EstimateStoredBytes(std::int64_t sample_count) { return 100 * sample_count; }

/// Samples in a blob, read in pieces and checked piece by piece: holds no more memory than the
/// piece, and a thousandth of the blob for its sums. Thread-safe.
class StoredSamples {
 public:
  /// Reads the header.
  /// @errors DATA_LOSS STORAGE_FAILED it is not one, or the blob is not as long as it says
  static absl::StatusOr<StoredSamples> Open(std::shared_ptr<const Blob> blob);

  std::int64_t sample_count() const { return sample_count_; }
  std::int64_t triangle_count() const { return triangle_count_; }
  /// The attributes that samples carry, without values.
  const std::vector<Attribute>& attributes() const { return attributes_; }

  /// False for a blob that was written without sums: whoever reads it checks it as a whole first.
  bool has_sums() const { return !sums_.empty(); }

  /// Samples [start, start + count), which must be inside; no triangles.
  /// @errors DATA_LOSS STORAGE_FAILED they are damaged | INTERNAL STORAGE_FAILED
  absl::StatusOr<SampleSet> ReadSamples(std::int64_t start, std::int64_t count) const;
  /// Triangles [start, start + count), which must be inside; nothing else. Errors the same.
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

  absl::Status ReadBytes(std::int64_t offset, std::span<char> out) const;
  template <typename T>
  absl::StatusOr<std::vector<T>> ReadRows(std::int64_t offset, std::int64_t start,
                                          std::int64_t count, int columns) const;

  std::shared_ptr<const Blob> blob_;
  std::string sums_;  // Empty where it has none.
  std::int64_t sample_count_ = 0;
  std::int64_t triangle_count_ = 0;
  std::vector<Attribute> attributes_;
  Offsets offsets_;
};

}  // namespace ccst::server
