#include "core/sampling/sampling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/quality/distances.h"
#include "core/sampling/initial_mesh.h"
#include "core/sampling/initial_points.h"
#include "core/sampling/plan.h"
#include "core/sampling/relaxation.h"
#include "core/sampling/source_map.h"
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
  for (const ComponentPlan& component : plan.components) {
    if (!component.points) continue;
    ++summary.untriangulated_components;
    summary.untriangulated_samples += component.samples;
  }
  return summary;
}

SampleSet Export(const TriangleMesh& mesh, const SourceMap& sources, const Samples& samples,
                 const SampleMesh& triangulation) {
  SampleSet set;
  const std::int32_t n = samples.count();
  set.faces.resize(n);
  set.normals = samples.normal;
  set.barycentrics.resize(n);
  set.positions.resize(n);
  for (std::int32_t i = 0; i < n; ++i) {
    // The two weights that are reported determine the position; the third is what they leave.
    const Eigen::Vector3d weights = sources.Weights(samples.face[i], samples.weights[i]);
    const double u = std::clamp(weights[0], 0.0, 1.0);
    const double v = std::clamp(weights[1], 0.0, 1.0 - u);
    set.barycentrics[i] = {u, v};
    set.faces[i] = sources.Face(samples.face[i]);
    const Eigen::Vector3i& face = mesh.faces[set.faces[i]];
    set.positions[i] = u * mesh.positions[face[0]] + v * mesh.positions[face[1]] +
                       (1.0 - u - v) * mesh.positions[face[2]];
  }
  set.triangles.reserve(triangulation.triangle_count());
  for (std::int32_t t = 0; t < triangulation.triangle_count(); ++t) {
    set.triangles.emplace_back(triangulation.origin[3 * t], triangulation.origin[3 * t + 1],
                               triangulation.origin[3 * t + 2]);
  }
  return set;
}

/// The initial samples and their triangulation.
struct Start {
  Plan plan;
  Samples samples;
  SampleMesh mesh;
};

/// @param smallest  set to the next count worth trying when this one is too small.
absl::StatusOr<Start> TryStart(const Surface& surface, std::int64_t count, std::uint64_t seed,
                               Interrupt* interrupt, std::int64_t* smallest) {
  Start start;
  *smallest = count + 1;
  CCST_ASSIGN_OR_RETURN(start.plan, MakePlan(surface, count, seed, smallest));
  start.samples = DrawInitialPoints(surface, start.plan, seed);
  std::vector<std::int32_t> failed;
  const bool several = start.plan.components.size() > 1;
  CCST_ASSIGN_OR_RETURN(start.mesh, BuildInitialMesh(surface, start.plan, start.samples, interrupt,
                                                     several ? &failed : nullptr));
  if (failed.empty()) return start;
  // Those components get points instead; drawing again changes nothing on the others.
  for (const std::int32_t c : failed) start.plan.MakePoints(surface, c);
  start.samples = DrawInitialPoints(surface, start.plan, seed);
  return start;
}

/// Like TryStart(); when the count is too small for the topology, the error names the next one
/// that works with this seed.
absl::StatusOr<Start> MakeStart(const Surface& surface, const SamplingOptions& options,
                                Interrupt* interrupt) {
  std::int64_t next = 0;
  absl::StatusOr<Start> start =
      TryStart(surface, options.sample_count, options.seed, interrupt, &next);
  constexpr int kMaxTries = 64;
  for (int attempt = 0; attempt < kMaxTries && next <= kMaxSampleCount; ++attempt) {
    if (start.ok() || GetErrorReason(start.status()) != ErrorReason::kCountTooSmall) return start;
    const std::int64_t count = next;
    const absl::StatusOr<Start> other = TryStart(surface, count, options.seed, interrupt, &next);
    if (absl::IsCancelled(other.status())) return other.status();
    if (!other.ok()) continue;
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
                     absl::StrCat(start.status().message(), " (", surface.component_areas().size(),
                                  " components, ", surface.boundary_loops().size(),
                                  " boundary loops); the smallest that works is ", count));
  }
  return start;
}

/// Smallest distance between samples on the same side over the hexagonal spacing.
double RelativeRadius(const Surface& surface, const Samples& samples) {
  std::vector<Eigen::Vector3d> normals(samples.position.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Eigen::Vector3i& face = surface.faces()[samples.face[i]];
    const Eigen::Vector3d& corner = surface.positions()[face[0]];
    normals[i] = (surface.positions()[face[1]] - corner)
                     .cross(surface.positions()[face[2]] - corner)
                     .normalized();
  }
  return quality::MeasureDistances(samples.position, normals, surface.area())
      .relative_radius_same_side;
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
  if (!(weld_tolerance >= 0.0) || !std::isfinite(weld_tolerance)) {
    return OptionError(absl::StrCat("weld_tolerance is ", weld_tolerance,
                                    "; it must be a finite length, at least 0"));
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
  // The time limit bounds the relaxation; without initial samples there is nothing to return.
  Interrupt stop(run.stop);
  const auto enter = [&](Phase phase) {
    if (run.progress != nullptr) run.progress->OnPhase(phase);
  };
  enter(Phase::kPreparing);
  CCST_ASSIGN_OR_RETURN(RepairedMesh repaired,
                        Repair(mesh, {.weld_tolerance = options.weld_tolerance}, &stop));
  CCST_ASSIGN_OR_RETURN(const Surface surface, Surface::Build(repaired.mesh, &stop));
  const SourceMap sources(mesh, repaired);
  repaired.mesh = {};  // From here on there is the surface.
  if (stop.Requested()) return absl::CancelledError("stopped before the first samples");
  SamplingResult result;
  result.prepare_seconds = SecondsSince(start);

  enter(Phase::kInitializing);
  CCST_ASSIGN_OR_RETURN(Start first, MakeStart(surface, options, &stop));
  result.surface = Summarise(surface, first.plan);
  result.surface.repairs = repaired.report;
  result.initialise_seconds = SecondsSince(start) - result.prepare_seconds;

  enter(Phase::kRelaxing);
  std::vector<Eigen::Vector3d> positions;
  const auto report = [&](const AlternationReport& alternation) {
    if (run.progress == nullptr) return;
    AlternationReport copy = alternation;
    copy.max_displacement *= surface.unit();
    copy.elapsed_seconds = SecondsSince(start);
    positions.resize(first.samples.position.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = surface.ToMesh(first.samples.position[i]);
    }
    copy.positions = positions;
    run.progress->OnAlternation(copy);
  };
  std::optional<Clock::time_point> deadline;
  if (options.time_limit_seconds.has_value()) {
    // Beyond a year it is no limit, and the clock's range would not hold every double.
    const double seconds = std::min(*options.time_limit_seconds, 3.2e7);
    deadline =
        start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  Interrupt interrupt(run.stop, deadline);
  const RelaxationReport relaxed =
      Relax(surface, first.plan, options, report, &interrupt, &first.mesh, &first.samples);
  result.termination = relaxed.termination;
  result.alternations = relaxed.alternations;
  result.passes = relaxed.passes;
  result.energy = relaxed.energy;
  result.capacity_cv = relaxed.capacity_cv;
  result.optimise_seconds =
      SecondsSince(start) - result.prepare_seconds - result.initialise_seconds;

  enter(Phase::kFinalizing);
  result.samples = Export(mesh, sources, first.samples, first.mesh);
  if (result.termination != Termination::kStopped) {
    result.relative_radius = RelativeRadius(surface, first.samples);
  }
  return result;
}

}  // namespace ccst
