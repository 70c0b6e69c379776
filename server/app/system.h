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

/// Writes a line of the log to standard error, after those before it. Does not wait for who reads
/// there, see LogStream.
void WriteToStandardError(const std::string& line);

/// Writes what waits for standard error and sums up what was left out; called now and then.
void TendLog();

/// Waits a second at most until what was logged is written.
void FinishLog();

/// A random (version 4) UUID.
std::string NewUuid();

/// What a Draco mesh announces; refuses what is over the limits.
/// @errors as DecodeDraco()
absl::StatusOr<MeshCounts> CountDraco(const ByteSource& source, const MeshLimits& limits);

/// Decodes Draco, samples with the core.
RunDependencies RealRunDependencies(const Clock& clock, const MeshLimits& mesh_limits);

}  // namespace ccst::server
