#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"
#include "core/density/image.h"
#include "core/mesh/triangle_mesh.h"
#include "server/base/executor.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/run_dependencies.h"

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
///       | DEADLINE_EXCEEDED TIME_LIMIT_EXCEEDED at the `deadline`
///       | RESOURCE_EXHAUSTED OUT_OF_MEMORY | INTERNAL
absl::StatusOr<JobInput> LoadInput(const JobSpec& spec, const RunDependencies& dependencies,
                                   const InputSource& source, const std::stop_token& stop,
                                   std::optional<Interrupt::Clock::time_point> deadline = {});

/// CANCELLED: how a computation ends that was asked to stop.
absl::Status StoppedOnRequest();

}  // namespace ccst::server
