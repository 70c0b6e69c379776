#include "core/sampling/sampling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "absl/strings/str_cat.h"
#include "core/base/assert.h"
#include "core/base/interrupt.h"
#include "core/base/status.h"
#include "core/density/density.h"
#include "core/mesh/attributes.h"
#include "core/parallel/parallel.h"
#include "core/quality/distances.h"
#include "core/sampling/input/prepared_surface.h"
#include "core/sampling/mesh/faults.h"
#include "core/sampling/other_methods.h"
#include "core/sampling/output/export.h"
#include "core/sampling/output/progressive_order.h"
#include "core/sampling/output/stages.h"
#include "core/sampling/relax/relaxation.h"
#include "core/sampling/start/initial_mesh.h"
#include "core/sampling/start/initial_points.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"
#include "core/surface/surface_fault.h"

namespace ccst::internal {
namespace {

using Clock = std::chrono::steady_clock;

/// Shorter creases are noise at the scale of the samples, in spacings.
constexpr double kLeastCrease = 4.0;

/// Samples that one thread looks at in one go.
constexpr std::int64_t kPiece = 4096;

/// Seconds of one thread that a sample takes after the last alternation, and how many threads share
/// them.
constexpr double kFinishingSeconds = 1.5e-6;
constexpr int kFinishingThreads = 4;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
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
  CCST_ASSIGN_OR_RETURN(start.plan,
                        MakePlan(surface, density, creases, count, seed, smallest, interrupt));
  CCST_ASSIGN_OR_RETURN(start.samples,
                        DrawInitialPoints(surface, density, start.plan, seed, interrupt, parallel));
  std::vector<std::int32_t> failed;
  const bool several = start.plan.components.size() > 1;
  CCST_ASSIGN_OR_RETURN(start.mesh, BuildInitialMesh(surface, start.plan, start.samples, interrupt,
                                                     several ? &failed : nullptr, parallel));
  CCST_ASSERT_NO_FAULT(FindFault(start.mesh));
  CCST_ASSERT_NO_FAULT(FindFault(start.samples, surface));
  if (failed.empty()) return start;
  // Those components get points instead; drawing again changes nothing on the others.
  for (const std::int32_t c : failed) start.plan.MakePoints(c);
  CCST_ASSIGN_OR_RETURN(start.samples,
                        DrawInitialPoints(surface, density, start.plan, seed, interrupt, parallel));
  return start;
}

/// A count that works is looked for by making starts of at most this many samples, or this many
/// times those asked for: whoever asks for few does not pay for the millions that a thin surface
/// would need.
constexpr std::int64_t kSurelyTried = 20'000;
constexpr std::int64_t kMostTimesTried = 4;

/// `too_small`, the error of TryStart(), with the smallest count that works with this seed, or as
/// much as is known of it.
/// @param next  the next count worth trying.
absl::Status NameCountThatWorks(const Surface& surface, const Density& density,
                                const std::vector<Crease>& creases, const absl::Status& too_small,
                                std::int64_t next, const SamplingOptions& options,
                                const Parallel& parallel, Interrupt* interrupt) {
  const auto refuse = [&](const char* what, std::int64_t count) {
    return MakeError(
        absl::StatusCode::kInvalidArgument, ErrorReason::kCountTooSmall,
        absl::StrCat(too_small.message(), " (", surface.component_areas().size(), " components, ",
                     surface.boundary_loops().size(), " boundary loops); ", what, count));
  };
  constexpr int kMaxTries = 64;
  const std::int64_t most_tried =
      std::min(kMaxSampleCount, std::max(kSurelyTried, kMostTimesTried * options.sample_count));
  for (int attempt = 0; attempt < kMaxTries && next <= most_tried; ++attempt) {
    const std::int64_t count = next;
    const absl::Status tried =
        TryStart(surface, density, creases, count, options.seed, parallel, interrupt, &next)
            .status();
    if (tried.ok()) return refuse("the smallest that works is ", count);
    // That it is too small is known even when the time is up.
    if (interrupt->cause() == Interrupt::Cause::kTimeLimit) break;
    if (GetErrorReason(tried) != ErrorReason::kCountTooSmall) return tried;
  }
  if (next <= kMaxSampleCount) return refuse("at least this many are needed: ", next);
  return refuse(
      "its boundary and creases are so long for its area that they take more than the most "
      "samples there may be: ",
      kMaxSampleCount);
}

/// Like TryStart(); when the count is too small for the topology, the error says which one works.
absl::StatusOr<Start> MakeStart(const Surface& surface, const Density& density,
                                const SamplingOptions& options, const Parallel& parallel,
                                Interrupt* interrupt) {
  std::vector<Crease> creases;
  if (options.crease_angle.has_value()) {
    const double spacing = quality::HexagonalSpacing(surface.area(), options.sample_count);
    creases = FindCreases(surface, *options.crease_angle, kLeastCrease * spacing, interrupt);
    if (interrupt->Requested()) return interrupt->Error("creases were looked for");
  }
  std::int64_t next = 0;
  absl::StatusOr<Start> start = TryStart(surface, density, creases, options.sample_count,
                                         options.seed, parallel, interrupt, &next);
  if (start.ok() || GetErrorReason(start.status()) != ErrorReason::kCountTooSmall) return start;
  return NameCountThatWorks(surface, density, creases, start.status(), next, options, parallel,
                            interrupt);
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
      normals[i] = surface.FaceCross(samples.face[i]).normalized();
    }
  });
  return quality::FindClosestSameSide(samples.position, normals, scales, interrupt, parallel)
             .distance /
         quality::HexagonalSpacing(surface.area(), samples.count());
}

std::optional<Clock::time_point> DeadlineOf(const SamplingOptions& options,
                                            Clock::time_point start) {
  if (!options.time_limit_seconds.has_value()) return std::nullopt;
  return Interrupt::DeadlineAfter(start, *options.time_limit_seconds);
}

/// About what ordering, measuring and exporting the samples takes. Methods that can end at any time
/// end this much before the time limit.
Clock::duration FinishingTime(const SamplingOptions& options) {
  const double seconds = kFinishingSeconds * static_cast<double>(options.sample_count) /
                         std::min(options.thread_count, kFinishingThreads);
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
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

absl::StatusOr<SamplingResult> Run(const TriangleMesh& mesh, const SamplingOptions& options,
                                   const RunControl& run) {
  CCST_RETURN_IF_ERROR(options.Validate());
  CCST_RETURN_IF_ERROR(CheckAttributes(mesh));
  const Clock::time_point start = Clock::now();
  Interrupt stop(run.stop, DeadlineOf(options, start));
  const auto enter = [&](Phase phase) {
    if (run.progress != nullptr) run.progress->OnPhase(phase);
  };
  enter(Phase::kPreparing);
  const Parallel parallel(options.thread_count);
  CCST_ASSIGN_OR_RETURN(const PreparedSurface prepared,
                        Prepare(mesh, options, Purpose::kSampling, &stop, parallel, run.stages));
  const Surface& surface = prepared.surface;
  const Density& density = prepared.density;
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
  enter(Phase::kInitializing);
  Start first;
  const auto show = [&](Stage stage) {
    ShowSamples(stage, surface, first.mesh, first.samples, run.stages);
  };
  if (options.method == SamplingMethod::kCcst) {
    CCST_ASSIGN_OR_RETURN(first, MakeStart(surface, density, options, parallel, &stop));
    show(Stage::kInitial);
  }
  result.surface = Summarise(surface, first.plan);
  result.surface.vertices = prepared.vertex_count;
  result.surface.faces = prepared.face_count;
  result.surface.repairs = prepared.repairs;
  result.initialise_seconds = SecondsSince(start) - result.prepare_seconds;

  enter(Phase::kRelaxing);
  const Clock::duration reserve = FinishingTime(options);
  RelaxationReport relaxed;
  if (options.method == SamplingMethod::kCcst) {
    Relaxation relaxation(&surface, &density, &first.plan, options,
                          {.on_alternation = report, .on_stage = show}, &stop, reserve, &first.mesh,
                          &first.samples);
    CCST_ASSIGN_OR_RETURN(relaxed, relaxation.Run());
  } else {
    CCST_ASSIGN_OR_RETURN(
        relaxed, RunOtherMethod(surface, density, options, report, &stop, reserve, &first.samples));
  }
  result.termination = relaxed.termination;
  result.alternations = relaxed.alternations;
  result.passes = relaxed.passes;
  result.energy = relaxed.energy;
  result.capacity_cv = relaxed.capacity_cv;
  result.optimise_seconds =
      SecondsSince(start) - result.prepare_seconds - result.initialise_seconds;

  CCST_ASSERT_NO_FAULT(FindFault(surface));
  CCST_ASSERT_NO_FAULT(FindFault(first.mesh));
  CCST_ASSERT_NO_FAULT(FindFault(first.samples, surface));
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
    // Whoever stops a run waits for neither, and a limit is one for these too.
    result.termination = stop.cause() == Interrupt::Cause::kTimeLimit ? Termination::kTimeLimit
                                                                      : Termination::kStopped;
    result.relative_radius = 0.0;
    order = OwnOrder(first.samples);
  }
  result.samples =
      ExportSamples(mesh, prepared.sources, first.samples, first.mesh, order, parallel);
  if (run.stages != nullptr) {
    run.stages->OnStage(Stage::kResult, result.samples.positions, result.samples.triangles);
  }
  return result;
}

}  // namespace
}  // namespace ccst::internal

namespace ccst {

absl::StatusOr<SamplingResult> SampleSurface(const TriangleMesh& mesh,
                                             const SamplingOptions& options,
                                             const RunControl& run) {
  return internal::Run(mesh, options, run);
}

}  // namespace ccst
