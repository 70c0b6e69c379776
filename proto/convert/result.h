#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "ccst/v1/job.pb.h"
#include "ccst/v1/mesh.pb.h"
#include "core/sampling/sampling.h"

namespace ccst {

/// What `v1::SamplingResult` holds beside the figures of a `SamplingResult`.
struct RunRecord {
  std::optional<AlternationReport> last_report;  ///< Without positions.
  std::string samples_sha256;
  std::int64_t samples_bytes = 0;  ///< Length of the byte layout the digest is of.
  double queue_seconds = 0.0;
  double decode_seconds = 0.0;
  double total_seconds = 0.0;  ///< Decoding and the run.
  std::vector<std::string> warnings;
};

/// The figures of a result, without its arrays, and their sizes.
struct ResultFigures {
  SamplingResult result;  ///< `samples` empty.
  RunRecord record;
  std::int64_t sample_count = 0;
  std::int64_t sample_mesh_face_count = 0;
};

v1::SurfaceSummary ToProto(const SurfaceSummary& surface);
SurfaceSummary FromProto(const v1::SurfaceSummary& surface);

/// The sizes come from the arrays of `result.samples`.
v1::SamplingResult ToProto(const SamplingResult& result, const RunRecord& record);

/// The wire form of figures whose arrays travelled apart.
v1::SamplingResult ToProto(const ResultFigures& figures);

/// INTERNAL when the termination is not one this version knows.
absl::StatusOr<ResultFigures> FromProto(const v1::SamplingResult& result);

}  // namespace ccst
