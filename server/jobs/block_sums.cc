#include "server/jobs/block_sums.h"

#include <algorithm>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

std::string SumOf(const std::string& digest) {
  return digest.substr(0, static_cast<std::size_t>(BlockSums::kSumBytes));
}

}  // namespace

std::int64_t BlockSums::SizeFor(std::int64_t bytes) {
  return (bytes + kBlockBytes - 1) / kBlockBytes * kSumBytes;
}

void BlockSums::Add(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto room = static_cast<std::size_t>(kBlockBytes - block_bytes_);
    const std::string_view part = bytes.substr(0, room);
    hash_.Add(part);
    block_bytes_ += static_cast<std::int64_t>(part.size());
    bytes.remove_prefix(part.size());
    if (block_bytes_ == kBlockBytes) EndBlock();
  }
}

std::string BlockSums::Finish() {
  if (block_bytes_ > 0) EndBlock();
  return std::move(sums_);
}

void BlockSums::EndBlock() {
  sums_ += SumOf(hash_.Finish());
  hash_ = Sha256();
  block_bytes_ = 0;
}

absl::Status ReadChecked(const Blob& blob, std::int64_t size, std::string_view sums,
                         std::int64_t offset, std::span<char> out) {
  if (out.empty()) return absl::OkStatus();
  const std::int64_t end = offset + static_cast<std::int64_t>(out.size());
  std::string block;
  for (std::int64_t i = offset / BlockSums::kBlockBytes; i * BlockSums::kBlockBytes < end; ++i) {
    const std::int64_t begin = i * BlockSums::kBlockBytes;
    block.resize(static_cast<std::size_t>(std::min(BlockSums::kBlockBytes, size - begin)));
    CCST_RETURN_IF_ERROR(blob.Read(begin, block));
    const auto sum = sums.substr(static_cast<std::size_t>(i * BlockSums::kSumBytes),
                                 static_cast<std::size_t>(BlockSums::kSumBytes));
    if (SumOf(Sha256Of(block)) != sum) {
      blob.Doubt();
      return MakeError(
          absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
          absl::StrCat("bytes ", begin, " to ", begin + static_cast<std::int64_t>(block.size()) - 1,
                       " are not those that were stored"));
    }
    const std::int64_t from = std::max(offset, begin);
    const std::int64_t to = std::min(end, begin + static_cast<std::int64_t>(block.size()));
    std::memcpy(out.data() + (from - offset), block.data() + (from - begin),
                static_cast<std::size_t>(to - from));
  }
  return absl::OkStatus();
}

}  // namespace ccst::server
