#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/mesh/triangle_mesh.h"
#include "server/base/executor.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/run_dependencies.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// What a job computes on, decoded.
struct JobInput {
  TriangleMesh mesh;
  std::shared_ptr<const Image> image;  ///< Of a texture density; else null.
};

/// Where it comes from.
struct InputSource {
  /// The bytes stored under a digest.
  std::function<absl::StatusOr<std::string>(const std::string& sha256)> load;
  /// Where decoders run, which cannot be interrupted: one that is stopped is left behind.
  Executor& decoders;
  /// The memory of the input, which what is left behind still uses.
  std::shared_ptr<void> grant;
};

/// Loads and decodes mesh and image of `spec`. Does not throw.
/// @errors those of `load` and of the decoders | CANCELLED as soon as `stop` is requested
///       | RESOURCE_EXHAUSTED OUT_OF_MEMORY | INTERNAL
absl::StatusOr<JobInput> LoadInput(const JobSpec& spec, const RunDependencies& dependencies,
                                   const InputSource& source, const std::stop_token& stop);

/// What the stored mesh announces. Reads its first bytes, all of them where those do not say.
/// @errors FAILED_PRECONDITION MESH_MISSING | INVALID_ARGUMENT as `dependencies.count`
///       | INTERNAL STORAGE_FAILED
absl::StatusOr<MeshCounts> CountMesh(const BlobStore& blobs, const std::string& sha256,
                                     const RunDependencies& dependencies);

/// CANCELLED: how a computation ends that was asked to stop.
absl::Status StoppedOnRequest();

}  // namespace ccst::server
