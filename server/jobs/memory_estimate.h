#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "core/io/image_file.h"
#include "core/sampling/sampling.h"
#include "server/jobs/held_inputs.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/run_dependencies.h"
#include "server/store/blob_store.h"

namespace ccst::server {

/// What the input of a job announces, before anything of it is decoded.
struct InputCounts {
  MeshCounts mesh = {};
  ImageFacts image = {};                 ///< Of a texture density; else all 0.
  std::int64_t encoded_image_bytes = 0;  ///< The same.
};

/// What a computation may need at its peak [bytes]. Figures were measured with a count of every
/// allocation (tests/server/job_memory_test.cc), and are a tenth above what came out; what is
/// really used is within one and a half of them.

/// Decoding and measuring an uploaded mesh.
std::int64_t EstimateUpload(const MeshCounts& mesh);
/// A job: decoding its input, sampling, and what is kept until the samples are stored.
std::int64_t EstimateJob(const InputCounts& input, const SamplingOptions& options);
/// Measuring `sample_count` samples of a job on its mesh, which is decoded anew.
std::int64_t EstimateAnalysis(const InputCounts& input, const DensityOptions& density,
                              std::int64_t sample_count);

/// What the stored mesh announces. Reads what it needs and no more.
/// @errors FAILED_PRECONDITION MESH_MISSING | INVALID_ARGUMENT as `dependencies.count`
///       | DATA_LOSS STORAGE_FAILED it is damaged | INTERNAL STORAGE_FAILED
absl::StatusOr<MeshCounts> CountMesh(const BlobStore& blobs, const std::string& sha256,
                                     const RunDependencies& dependencies);

/// What mesh and image of `spec` announce; the mesh that of `held` where it is not null. Errors as
/// CountMesh(), and `dependencies.image_facts`.
absl::StatusOr<InputCounts> CountInput(const BlobStore& blobs, const JobSpec& spec,
                                       const RunDependencies& dependencies,
                                       const std::shared_ptr<const HeldInput>& held = nullptr);

}  // namespace ccst::server
