#include "core/sampling/sampling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/sampling/initial_mesh.h"
#include "core/sampling/initial_points.h"
#include "core/sampling/plan.h"
#include "core/sampling/relaxation.h"
#include "core/surface/surface.h"

namespace ccst {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

absl::Status OptionError(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

SurfaceSummary Summarise(const Surface& surface, const Plan& plan) {
  SurfaceSummary summary;
  summary.vertices = surface.vertex_count();
  summary.faces = surface.face_count();
  summary.area = surface.area() * surface.unit() * surface.unit();
  summary.diagonal = surface.diagonal() * surface.unit();
  summary.components = static_cast<std::int64_t>(surface.component_areas().size());
  summary.boundary_loops = static_cast<std::int64_t>(surface.boundary_loops().size());
  for (const std::int64_t euler : surface.component_eulers()) summary.euler += euler;
  summary.closed_loops = plan.closed_loops;
  summary.welded_vertices = surface.welded_vertices();
  summary.isolated_vertices = surface.isolated_vertices();
  return summary;
}

SampleSet Export(const TriangleMesh& mesh, const Samples& samples,
                 const SampleMesh& triangulation) {
  SampleSet set;
  const std::int32_t n = samples.count();
  set.faces = samples.face;
  set.normals = samples.normal;
  set.barycentrics.resize(n);
  set.positions.resize(n);
  for (std::int32_t i = 0; i < n; ++i) {
    // The two weights that are reported determine the position; the third is what they leave.
    const double u = std::clamp(samples.weights[i][0], 0.0, 1.0);
    const double v = std::clamp(samples.weights[i][1], 0.0, 1.0 - u);
    set.barycentrics[i] = {u, v};
    const Eigen::Vector3i& face = mesh.faces[samples.face[i]];
    set.positions[i] = u * mesh.positions[face[0]] + v * mesh.positions[face[1]] +
                       (1.0 - u - v) * mesh.positions[face[2]];
  }
  for (std::int32_t t = 0; t < triangulation.triangle_count(); ++t) {
    set.triangles.emplace_back(triangulation.origin[3 * t], triangulation.origin[3 * t + 1],
                               triangulation.origin[3 * t + 2]);
  }
  return set;
}

}  // namespace

absl::Status SamplingOptions::Validate() const {
  if (sample_count < kMinSampleCount || sample_count > kMaxSampleCount) {
    return OptionError(absl::StrCat("sample_count is ", sample_count, "; it must be in [",
                                    kMinSampleCount, ", ", kMaxSampleCount, "]"));
  }
  if (max_iterations < 0 || max_iterations > kMaxAlternations) {
    return OptionError(absl::StrCat("max_iterations is ", max_iterations, "; it must be in [0, ",
                                    kMaxAlternations, "]"));
  }
  if (!(relative_tolerance > 0.0) || !std::isfinite(relative_tolerance)) {
    return OptionError(absl::StrCat("relative_tolerance is ", relative_tolerance,
                                    "; it must be finite and greater than 0"));
  }
  if (time_limit_seconds.has_value() && !(*time_limit_seconds > 0.0)) {
    return OptionError(
        absl::StrCat("time_limit_seconds is ", *time_limit_seconds, "; it must be greater than 0"));
  }
  if (thread_count < 1) {
    return OptionError(absl::StrCat("thread_count is ", thread_count, "; it must be at least 1"));
  }
  return absl::OkStatus();
}

absl::StatusOr<SamplingResult> SampleSurface(const TriangleMesh& mesh,
                                             const SamplingOptions& options,
                                             const RunControl& run) {
  CCST_RETURN_IF_ERROR(options.Validate());
  const Clock::time_point start = Clock::now();
  const auto enter = [&](Phase phase) {
    if (run.progress != nullptr) run.progress->OnPhase(phase);
  };
  enter(Phase::kPreparing);
  CCST_ASSIGN_OR_RETURN(const Surface surface, Surface::Build(mesh));
  CCST_ASSIGN_OR_RETURN(const Plan plan, MakePlan(surface, options.sample_count, options.seed));
  if (run.stop.stop_requested()) return absl::CancelledError("stopped before the first samples");
  SamplingResult result;
  result.surface = Summarise(surface, plan);
  result.prepare_seconds = SecondsSince(start);

  enter(Phase::kInitializing);
  Samples samples = DrawInitialPoints(surface, plan, options.seed);
  CCST_ASSIGN_OR_RETURN(SampleMesh triangulation, BuildInitialMesh(surface, plan, samples, run));
  result.initialise_seconds = SecondsSince(start) - result.prepare_seconds;

  enter(Phase::kRelaxing);
  const auto report = [&](const AlternationReport& alternation) {
    if (run.progress == nullptr) return;
    AlternationReport copy = alternation;
    copy.max_displacement *= surface.unit();
    copy.elapsed_seconds = SecondsSince(start);
    std::vector<Eigen::Vector3d> positions(samples.position.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = surface.ToMesh(samples.position[i]);
    }
    copy.positions = positions;
    run.progress->OnAlternation(copy);
  };
  const auto interrupted = [&](Termination* reason) {
    if (run.stop.stop_requested()) {
      *reason = Termination::kStopped;
      return true;
    }
    if (options.time_limit_seconds.has_value() &&
        SecondsSince(start) >= *options.time_limit_seconds) {
      *reason = Termination::kTimeLimit;
      return true;
    }
    return false;
  };
  const RelaxationReport relaxed =
      Relax(surface, plan, options, report, interrupted, &triangulation, &samples);
  result.termination = relaxed.termination;
  result.alternations = relaxed.alternations;
  result.passes = relaxed.passes;
  result.energy = relaxed.energy;
  result.capacity_cv = relaxed.capacity_cv;
  result.optimise_seconds =
      SecondsSince(start) - result.prepare_seconds - result.initialise_seconds;

  enter(Phase::kFinalizing);
  result.samples = Export(mesh, samples, triangulation);
  return result;
}

}  // namespace ccst
