#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "core/base/sha256.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// Sums of a byte string, one for each block of 16 KiB, by which any part can be checked without
/// the rest. A sum is the first 64 bits of the block's SHA-256, as 16 hexadecimal digits: more than
/// enough against damage, which nobody chooses.
class BlockSums {
 public:
  static constexpr std::int64_t kBlockBytes = std::int64_t{16} << 10;
  static constexpr std::int64_t kSumBytes = 16;

  /// Length of the sums of `bytes` bytes, in [0, 2^62].
  static std::int64_t SizeFor(std::int64_t bytes);

  void Add(std::string_view bytes);
  /// The sums of everything added, one after the other; once.
  std::string Finish();

 private:
  void EndBlock();

  Sha256 hash_;
  std::int64_t block_bytes_ = 0;  // Of the block under way.
  std::string sums_;
};

/// Fills `out` from `offset` with bytes of the first `size` of `blob`, whose sums are `sums`. Reads
/// the blocks that hold the range, and hashes each once.
/// @errors DATA_LOSS STORAGE_FAILED where a block has another sum | those of Blob::Read()
absl::Status ReadChecked(const Blob& blob, std::int64_t size, std::string_view sums,
                         std::int64_t offset, std::span<char> out);

}  // namespace ccst::server
