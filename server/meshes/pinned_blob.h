#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/meshes/blob_pins.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// The blob for readers that take their time: it is opened anew for every read, so that one who
/// waits holds no descriptor, and pinned, so that it stays readable until the reader lets go. Both
/// `blobs` and `pins` outlive it.
/// @errors those of BlobStore::Open()
absl::StatusOr<std::shared_ptr<const Blob>> OpenPinned(const BlobStore& blobs, BlobPins& pins,
                                                       const std::string& sha256);

}  // namespace ccst::server
