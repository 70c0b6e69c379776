#pragma once

#include <cstdint>

#include "absl/time/time.h"
#include "server/base/executor.h"
#include "server/meshes/mesh_store.h"
#include "server/rpc/call.h"
#include "server/rpc/upload_slots.h"

namespace ccst::server {

/// Limits on how meshes travel; the first two are advertised.
struct MeshServiceOptions {
  std::int64_t max_inline_mesh_bytes = std::int64_t{64} << 20;
  std::int64_t max_chunk_bytes = std::int64_t{1} << 20;
  int max_uploads = 64;             ///< At once, of all callers; each holds a chunk.
  int max_uploads_per_caller = 48;  ///< Leaves room for others.
  /// An upload without a message for this long is ended,
  absl::Duration max_idle = absl::Seconds(60);
  /// and one that has got ahead by less than this since it began, but for that time.
  double min_bytes_per_second = 16 * 1024;
};

/// What the calls of a MeshService share; outlives them.
struct MeshSupport {
  MeshStore& meshes;
  Executor& disk;      ///< Short work that blocks on the disk; a task a call at a time.
  Executor& decoding;  ///< Long work: bytes become a mesh and are measured.
  const CallSupport calls;
  const MeshServiceOptions options;
  UploadSlots uploads{options.max_uploads, options.max_uploads_per_caller};
};

}  // namespace ccst::server
