#include "core/sampling/sampling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/density/density.h"
#include "core/mesh/attributes.h"
#include "core/parallel/parallel.h"
#include "core/quality/distances.h"
#include "core/sampling/crease_refinement.h"
#include "core/sampling/density_source.h"
#include "core/sampling/export.h"
#include "core/sampling/face_order.h"
#include "core/sampling/initial_mesh.h"
#include "core/sampling/initial_points.h"
#include "core/sampling/other_methods.h"
#include "core/sampling/plan.h"
#include "core/sampling/progressive_order.h"
#include "core/sampling/relaxation.h"
#include "core/sampling/source_map.h"
#include "core/surface/surface.h"

namespace ccst {
namespace {

using Clock = std::chrono::steady_clock;

/// Shorter creases are noise at the scale of the samples, in spacings.
constexpr double kLeastCrease = 4.0;

/// Longest side of a face at a sharp edge, in spacings, and how many faces a sample may come of it.
constexpr double kLargestAtCrease = 1.0;
constexpr std::int64_t kMostNewFaces = 8;

/// Samples that one thread looks at in one go.
constexpr std::int64_t kPiece = 4096;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

absl::Status OptionError(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

SurfaceSummary Summarise(const Surface& surface, const Plan& plan) {
  SurfaceSummary summary;
  summary.area = surface.area() * surface.unit() * surface.unit();
  summary.diagonal = surface.diagonal() * surface.unit();
  summary.components = static_cast<std::int64_t>(surface.component_areas().size());
  summary.boundary_loops = static_cast<std::int64_t>(surface.boundary_loops().size());
  for (const std::int64_t euler : surface.component_eulers()) summary.euler += euler;
  summary.closed_loops = plan.closed_loops;
  summary.creases = std::count_if(plan.loops.begin(), plan.loops.end(),
                                  [](const LoopPlan& loop) { return loop.crease; });
  for (const ComponentPlan& component : plan.components) {
    if (!component.points) continue;
    ++summary.untriangulated_components;
    summary.untriangulated_samples += component.samples;
  }
  return summary;
}

/// The initial samples and their triangulation.
struct Start {
  Plan plan;
  Samples samples;
  SampleMesh mesh;
};

/// @param smallest  set to the next count worth trying when this one is too small.
absl::StatusOr<Start> TryStart(const Surface& surface, const Density& density,
                               const std::vector<Crease>& creases, std::int64_t count,
                               std::uint64_t seed, const Parallel& parallel, Interrupt* interrupt,
                               std::int64_t* smallest) {
  Start start;
  *smallest = count + 1;
  CCST_ASSIGN_OR_RETURN(start.plan, MakePlan(surface, density, creases, count, seed, smallest));
  CCST_ASSIGN_OR_RETURN(start.samples,
                        DrawInitialPoints(surface, density, start.plan, seed, interrupt, parallel));
  std::vector<std::int32_t> failed;
  const bool several = start.plan.components.size() > 1;
  CCST_ASSIGN_OR_RETURN(start.mesh, BuildInitialMesh(surface, start.plan, start.samples, interrupt,
                                                     several ? &failed : nullptr, parallel));
  if (failed.empty()) return start;
  // Those components get points instead; drawing again changes nothing on the others.
  for (const std::int32_t c : failed) start.plan.MakePoints(c);
  CCST_ASSIGN_OR_RETURN(start.samples,
                        DrawInitialPoints(surface, density, start.plan, seed, interrupt, parallel));
  return start;
}

/// Like TryStart(); when the count is too small for the topology, the error names the next one
/// that works with this seed.
absl::StatusOr<Start> MakeStart(const Surface& surface, const Density& density,
                                const SamplingOptions& options, const Parallel& parallel,
                                Interrupt* interrupt) {
  std::vector<Crease> creases;
  if (options.crease_angle.has_value()) {
    const double spacing = quality::HexagonalSpacing(surface.area(), options.sample_count);
    creases = FindCreases(surface, *options.crease_angle, kLeastCrease * spacing);
  }
  std::int64_t next = 0;
  absl::StatusOr<Start> start = TryStart(surface, density, creases, options.sample_count,
                                         options.seed, parallel, interrupt, &next);
  constexpr int kMaxTries = 64;
  for (int attempt = 0; attempt < kMaxTries && next <= kMaxSampleCount; ++attempt) {
    if (start.ok() || GetErrorReason(start.status()) != ErrorReason::kCountTooSmall) return start;
    const std::int64_t count = next;
    const absl::StatusOr<Start> other =
        TryStart(surface, density, creases, count, options.seed, parallel, interrupt, &next);
    if (absl::IsCancelled(other.status())) return other.status();
    if (!other.ok()) continue;
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
                     absl::StrCat(start.status().message(), " (", surface.component_areas().size(),
                                  " components, ", surface.boundary_loops().size(),
                                  " boundary loops); the smallest that works is ", count));
  }
  return start;
}

/// How much wider than r_max samples belong apart, per sample; empty where the density is uniform.
std::vector<double> SpacingScales(const Surface& surface, const Density& density,
                                  const Samples& samples, const Parallel& parallel) {
  std::vector<double> scales;
  if (density.uniform()) return scales;
  scales.resize(samples.position.size());
  const double footprint = 0.5 * surface.area() / samples.count();
  parallel.ForRanges(samples.count(), kPiece, [&](std::int64_t first, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
      scales[i] = 1.0 / std::sqrt(density.At(samples.face[i], samples.weights[i], footprint));
    }
  });
  return scales;
}

/// Smallest distance between samples on the same side over the hexagonal spacing; of those looked
/// at when `interrupt` was requested.
double RelativeRadius(const Surface& surface, const Samples& samples,
                      const std::vector<double>& scales, const Parallel& parallel,
                      Interrupt* interrupt) {
  std::vector<Eigen::Vector3d> normals(samples.position.size());
  parallel.ForRanges(samples.count(), kPiece, [&](std::int64_t first, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(end); ++i) {
      const Eigen::Vector3i& face = surface.faces()[samples.face[i]];
      const Eigen::Vector3d& corner = surface.positions()[face[0]];
      normals[i] = (surface.positions()[face[1]] - corner)
                       .cross(surface.positions()[face[2]] - corner)
                       .normalized();
    }
  });
  return quality::FindClosestSameSide(samples.position, normals, scales, interrupt, parallel)
             .distance /
         quality::HexagonalSpacing(surface.area(), samples.count());
}

std::vector<std::int32_t> OwnOrder(const Samples& samples) {
  std::vector<std::int32_t> order(samples.position.size());
  std::iota(order.begin(), order.end(), 0);
  return order;
}

/// Every prefix well spread, but for white noise, whose own order is as random as it is. Unfinished
/// when `interrupt` was requested.
std::vector<std::int32_t> OrderSamples(const Surface& surface, const Samples& samples,
                                       const std::vector<double>& scales,
                                       const SamplingOptions& options, const Parallel& parallel,
                                       Interrupt* interrupt) {
  if (options.method == SamplingMethod::kWhiteNoise) return OwnOrder(samples);
  return ProgressiveOrder(samples.position, samples.normal, scales,
                          quality::HexagonalSpacing(surface.area(), samples.count()), options.seed,
                          interrupt, parallel);
}

}  // namespace

int DefaultMaxIterations(SamplingMethod method) {
  switch (method) {
    case SamplingMethod::kLloyd:
      return 100;
    case SamplingMethod::kCcvt:
      return 1000;
    default:
      return SamplingOptions().max_iterations;
  }
}

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
  if (crease_angle.has_value() && !(*crease_angle > 0.0 && *crease_angle < std::numbers::pi)) {
    return OptionError(
        absl::StrCat("crease_angle is ", *crease_angle, "; it must be in (0, pi) radians"));
  }
  CCST_RETURN_IF_ERROR(ValidateDensity(density));
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
  CCST_RETURN_IF_ERROR(CheckAttributes(mesh));
  const Clock::time_point start = Clock::now();
  // The time limit bounds the relaxation; without initial samples there is nothing to return.
  Interrupt stop(run.stop);
  const auto enter = [&](Phase phase) {
    if (run.progress != nullptr) run.progress->OnPhase(phase);
  };
  enter(Phase::kPreparing);
  const Parallel parallel(options.thread_count);
  CCST_ASSIGN_OR_RETURN(RepairedMesh repaired,
                        Repair(mesh, {.weld_tolerance = options.weld_tolerance}, &stop, parallel));
  SortFaces(&repaired, &stop, parallel);
  CCST_ASSIGN_OR_RETURN(Surface surface, Surface::Build(repaired.mesh, &stop, parallel));
  const std::int64_t vertex_count = surface.vertex_count();
  const std::int64_t face_count = surface.face_count();
  const double spacing = quality::HexagonalSpacing(surface.area(), options.sample_count);
  if (options.method == SamplingMethod::kCcst &&
      RefineCreases(surface, kLargestAtCrease * spacing, kMostNewFaces * options.sample_count,
                    &repaired)) {
    SortFaces(&repaired, &stop, parallel);
    CCST_ASSIGN_OR_RETURN(surface, Surface::Build(repaired.mesh, &stop, parallel));
  }
  const SourceMap sources(mesh, repaired);
  repaired.mesh = {};  // From here on there is the surface.
  if (stop.Requested()) return absl::CancelledError("stopped before the first samples");
  CCST_ASSIGN_OR_RETURN(const Density density,
                        MakeDensity(mesh, sources, surface, options.density));
  SamplingResult result;
  result.prepare_seconds = SecondsSince(start);

  std::vector<Eigen::Vector3d> positions;
  const auto report = [&](const AlternationReport& alternation) {
    if (run.progress == nullptr) return;
    AlternationReport copy = alternation;
    copy.max_displacement *= surface.unit();
    copy.elapsed_seconds = SecondsSince(start);
    positions.resize(alternation.positions.size());
    std::transform(alternation.positions.begin(), alternation.positions.end(), positions.begin(),
                   [&](const Eigen::Vector3d& position) { return surface.ToMesh(position); });
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

  enter(Phase::kInitializing);
  Start first;
  if (options.method == SamplingMethod::kCcst) {
    CCST_ASSIGN_OR_RETURN(first, MakeStart(surface, density, options, parallel, &stop));
  }
  result.surface = Summarise(surface, first.plan);
  result.surface.vertices = vertex_count;
  result.surface.faces = face_count;
  result.surface.repairs = repaired.report;
  result.initialise_seconds = SecondsSince(start) - result.prepare_seconds;

  enter(Phase::kRelaxing);
  Interrupt interrupt(run.stop, deadline);
  RelaxationReport relaxed;
  if (options.method == SamplingMethod::kCcst) {
    relaxed = Relax(surface, density, first.plan, options, report, &interrupt, &stop, &first.mesh,
                    &first.samples);
  } else {
    // The others have nothing to return before they end.
    const bool improves =
        options.method == SamplingMethod::kLloyd || options.method == SamplingMethod::kCcvt;
    CCST_ASSIGN_OR_RETURN(relaxed, RunOtherMethod(surface, density, options, report,
                                                  improves ? &interrupt : &stop, &first.samples));
  }
  result.termination = relaxed.termination;
  result.alternations = relaxed.alternations;
  result.passes = relaxed.passes;
  result.energy = relaxed.energy;
  result.capacity_cv = relaxed.capacity_cv;
  result.optimise_seconds =
      SecondsSince(start) - result.prepare_seconds - result.initialise_seconds;

  enter(Phase::kFinalizing);
  std::vector<std::int32_t> order;
  if (!stop.Requested()) {
    const std::vector<double> scales = SpacingScales(surface, density, first.samples, parallel);
    parallel.For(2, [&, token = stop](std::int64_t task) {
      Interrupt own = token;
      if (task == 0) {
        order = OrderSamples(surface, first.samples, scales, options, parallel, &own);
      } else {
        result.relative_radius = RelativeRadius(surface, first.samples, scales, parallel, &own);
      }
    });
  }
  if (stop.Requested()) {
    // Whoever stops a run waits for neither.
    result.termination = Termination::kStopped;
    result.relative_radius = 0.0;
    order = OwnOrder(first.samples);
  }
  result.samples = ExportSamples(mesh, sources, first.samples, first.mesh, order, parallel);
  return result;
}

}  // namespace ccst
