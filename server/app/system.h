#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/io/mesh_limits.h"
#include "server/base/clock.h"
#include "server/jobs/run_job.h"

namespace ccst::server {

/// The machine's clocks.
Clock SystemClock();

/// Writes a line of the log, whole and at once.
void WriteToStandardError(const std::string& line);

/// A random (version 4) UUID.
std::string NewUuid();

/// What a Draco mesh announces; refuses what is over the limits.
/// @errors as DecodeDraco()
absl::StatusOr<MeshCounts> CountDraco(std::span<const char> start, std::int64_t size,
                                      const MeshLimits& limits);

/// Decodes Draco, samples with the core.
RunDependencies RealRunDependencies(const Clock& clock, const MeshLimits& mesh_limits);

}  // namespace ccst::server
