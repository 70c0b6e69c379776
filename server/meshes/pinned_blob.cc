#include "server/meshes/pinned_blob.h"

#include <cstdint>
#include <span>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

class PinnedBlob final : public Blob {
 public:
  PinnedBlob(const BlobStore& blobs, BlobPins& pins, std::string sha256)
      : blobs_(blobs), sha256_(std::move(sha256)), pin_(pins, sha256_) {}

  absl::Status Measure() {
    std::shared_ptr<const Blob> blob;
    CCST_ASSIGN_OR_RETURN(blob, blobs_.Open(sha256_));
    size_bytes_ = blob->size_bytes();
    return absl::OkStatus();
  }

  std::int64_t size_bytes() const override { return size_bytes_; }

  absl::Status Read(std::int64_t offset, std::span<char> out) const override {
    std::shared_ptr<const Blob> blob;
    CCST_ASSIGN_OR_RETURN(blob, blobs_.Open(sha256_));
    return blob->Read(offset, out);
  }

  void Doubt() const override {
    if (const auto blob = blobs_.Open(sha256_); blob.ok()) (*blob)->Doubt();
  }

 private:
  const BlobStore& blobs_;
  const std::string sha256_;
  const BlobPins::Pin pin_;
  std::int64_t size_bytes_ = 0;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Blob>> OpenPinned(const BlobStore& blobs, BlobPins& pins,
                                                       const std::string& sha256) {
  auto blob = std::make_shared<PinnedBlob>(blobs, pins, sha256);
  CCST_RETURN_IF_ERROR(blob->Measure());
  return blob;
}

}  // namespace ccst::server
