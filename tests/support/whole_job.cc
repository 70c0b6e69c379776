#include "tests/support/whole_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "tests/support/memory_meter.h"
#include "tests/support/sample_hosts.h"

namespace ccst::test {
namespace {

/// What is wrong with a refusal.
std::string FaultOf(const absl::Status& status) {
  const std::optional<ErrorReason> reason = GetErrorReason(status);
  const auto lies_in_request = [&] {
    switch (*reason) {
      case ErrorReason::kOptionInvalid:
      case ErrorReason::kMeshEmpty:
      case ErrorReason::kMeshDegenerate:
      case ErrorReason::kDensityInvalid:
      case ErrorReason::kCountTooSmall:
      case ErrorReason::kLimitExceeded:
        return true;
      default:
        return false;
    }
  };
  if (absl::IsInvalidArgument(status) && reason.has_value() && lies_in_request() &&
      !status.message().empty()) {
    return "";
  }
  return absl::StrCat("it was refused so: ", status.ToString());
}

std::string FaultOf(const TriangleMesh& mesh, std::int64_t count, const SamplingResult& result) {
  if (result.termination == Termination::kTimeLimit) return "it did not come to an end";
  const SampleSet& set = result.samples;
  const auto size = [&mesh](const Eigen::Vector3i& face) {
    double largest = 0.0;
    for (const int v : face) largest = std::max(largest, mesh.positions[v].stableNorm());
    return largest;
  };
  const std::string fault = FindHostFault(
      mesh, count, set, [&](const Eigen::Vector3i& face) { return 1e-12 * size(face); });
  if (!fault.empty()) return fault;
  for (const Eigen::Vector3i& t : set.triangles) {
    if (t.minCoeff() < 0 || t.maxCoeff() >= count || t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      return "a triangle does not join three samples";
    }
  }
  if (!std::isfinite(result.energy) || !std::isfinite(result.capacity_cv) ||
      !std::isfinite(result.relative_radius)) {
    return absl::StrCat("its figures are energy ", result.energy, ", capacity_cv ",
                        result.capacity_cv, ", relative_radius ", result.relative_radius);
  }
  return "";
}

}  // namespace

std::string FindMisbehaviour(const TriangleMesh& mesh, SamplingOptions options,
                             const JobBounds& bounds) {
  using Clock = std::chrono::steady_clock;
  options.time_limit_seconds = bounds.seconds;
  std::optional<absl::StatusOr<SamplingResult>> result;
  std::int64_t peak = 0;
  const Clock::time_point start = Clock::now();
  {
    const MemoryMeter meter(bounds.bytes);
    try {
      result = SampleSurface(mesh, options);
    } catch (const std::bad_alloc&) {
      return absl::StrCat("it wants more than ", bounds.bytes, " bytes, ", meter.PeakBytes(),
                          " of which it has");
    }
    peak = meter.PeakBytes();
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  // Whoever looks at the limit often enough ends soon after it.
  if (seconds > 1.5 * bounds.seconds) return absl::StrCat("it took ", seconds, " s");
  const std::string fault =
      result->ok() ? FaultOf(mesh, options.sample_count, **result) : FaultOf(result->status());
  return fault.empty() ? "" : absl::StrCat(fault, " (", seconds, " s, ", peak, " bytes)");
}

}  // namespace ccst::test
