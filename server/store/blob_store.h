#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/sha256.h"

namespace ccst::server {

/// Bytes on their way into a BlobStore. Nothing stays of one that is destroyed uncommitted.
/// Not thread-safe.
class BlobWriter {
 public:
  virtual ~BlobWriter() = default;

  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | QUEUE_FULL | INVALID_ARGUMENT LIMIT_EXCEEDED the
  /// bytes
  ///         alone are over the limit on all blobs | INTERNAL STORAGE_FAILED
  virtual absl::Status Append(std::string_view bytes) = 0;
  virtual std::int64_t size_bytes() const = 0;

  /// SHA-256 of everything appended; no more may be appended.
  virtual const std::string& Seal() = 0;

  /// Makes the sealed bytes part of the store, under their digest; they survive a crash from then
  /// on. Committing bytes that are there already is right too. Errors as Append().
  virtual absl::Status Commit() = 0;
};

/// One stored blob. It stays readable while this exists, also when it is removed. Thread-safe.
class Blob {
 public:
  virtual ~Blob() = default;
  virtual std::int64_t size_bytes() const = 0;
  /// Fills `out` from `offset`; the range must be inside.
  /// @errors INTERNAL STORAGE_FAILED
  virtual absl::Status Read(std::int64_t offset, std::span<char> out) const = 0;
  /// A reader found that the bytes are not those of the digest: the next BlobStore::Check() looks.
  virtual void Doubt() const = 0;
};

/// Immutable byte strings, each under the SHA-256 of its content. What is read may be damaged:
/// readers check it, by ReadWhole(), CheckedReader or sums of their own. Committing the right bytes
/// heals a damaged blob. Thread-safe.
class BlobStore {
 public:
  virtual ~BlobStore() = default;

  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED
  virtual absl::StatusOr<std::unique_ptr<BlobWriter>> NewBlob() = 0;

  /// @errors NOT_FOUND NOT_FOUND | INTERNAL STORAGE_FAILED
  virtual absl::StatusOr<std::shared_ptr<const Blob>> Open(const std::string& sha256) const = 0;

  /// RESOURCE_EXHAUSTED STORAGE_FULL when `bytes` more are over the limit on all blobs, or more
  /// than the disk has; INVALID_ARGUMENT LIMIT_EXCEEDED when they alone are over the limit.
  virtual absl::Status CheckRoom(std::int64_t bytes) const = 0;

  /// What counts towards that limit: of all blobs, those on their way included.
  virtual std::int64_t used_bytes() const = 0;

  virtual bool Contains(const std::string& sha256) const = 0;

  /// Whether it is there with the bytes that its digest names. Reads and hashes all of them unless
  /// this was found, or they were written, since somebody last wrote to them.
  /// @errors NOT_FOUND NOT_FOUND | DATA_LOSS STORAGE_FAILED they are damaged
  ///       | INTERNAL STORAGE_FAILED
  virtual absl::Status Check(const std::string& sha256) const = 0;

  /// Nothing happens when it is not there.
  virtual absl::Status Remove(const std::string& sha256) = 0;

  /// Digests of all blobs, in no order; for collecting garbage.
  virtual absl::StatusOr<std::vector<std::string>> List() const = 0;
};

/// Reads a blob from its begin to its end, and knows at the end whether the bytes were right. Not
/// thread-safe.
class CheckedReader {
 public:
  CheckedReader(std::shared_ptr<const Blob> blob, std::string sha256);

  std::int64_t size_bytes() const { return blob_->size_bytes(); }
  /// Where the next bytes begin.
  std::int64_t offset() const { return offset_; }
  bool at_end() const { return offset_ == size_bytes(); }

  /// Fills `out`, at most what is left, with the next bytes. The last ones are only given when all
  /// were right.
  /// @errors DATA_LOSS STORAGE_FAILED they were not | as Blob::Read()
  absl::Status Next(std::span<char> out);

 private:
  const std::shared_ptr<const Blob> blob_;
  const std::string sha256_;
  std::int64_t offset_ = 0;
  Sha256 hash_;
};

/// DATA_LOSS STORAGE_FAILED: the stored bytes of `sha256` are others.
absl::Status DamagedBlob(const std::string& sha256);

/// The whole blob, checked against its digest.
/// @errors as BlobStore::Open() | DATA_LOSS STORAGE_FAILED when the bytes are damaged
absl::StatusOr<std::string> ReadWhole(const BlobStore& blobs, const std::string& sha256);

/// Stores `bytes` and returns their digest. Errors as BlobWriter::Append().
absl::StatusOr<std::string> PutWhole(BlobStore& blobs, std::string_view bytes);

}  // namespace ccst::server
