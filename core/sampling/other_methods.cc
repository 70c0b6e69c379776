#include "core/sampling/other_methods.h"

#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "core/methods/methods.h"

namespace ccst::internal {
namespace {

constexpr std::int64_t kMaxCount = 1'000'000;

void Take(const Surface& surface, const std::vector<SurfacePoint>& points, Samples* samples) {
  samples->Resize(static_cast<std::int32_t>(points.size()));
  for (std::int32_t i = 0; i < samples->count(); ++i) {
    samples->Place(i, surface, points[i]);
    samples->component[i] = surface.face_components()[points[i].face];
  }
}

RelaxationReport Summarise(const RelaxedSamples& relaxed, Interrupt* interrupt) {
  RelaxationReport result;
  result.alternations = relaxed.steps;
  result.passes = relaxed.steps;
  result.energy = relaxed.energy;
  if (relaxed.converged) {
    result.termination = Termination::kConverged;
  } else if (interrupt->Requested()) {
    result.termination = interrupt->cause() == Interrupt::Cause::kTimeLimit
                             ? Termination::kTimeLimit
                             : Termination::kStopped;
  }
  return result;
}

}  // namespace

absl::StatusOr<RelaxationReport> RunOtherMethod(
    const Surface& surface, const Density& density, const SamplingOptions& options,
    const std::function<void(const AlternationReport&)>& report, Interrupt* interrupt,
    Interrupt::Clock::duration reserve, Samples* samples) {
  const std::int64_t count = options.sample_count;
  if (count > kMaxCount) {
    return OverLimit({"max_sample_count", kMaxCount, count},
                     absl::StrCat("sample_count is ", count,
                                  "; methods other than CCST take at most ", kMaxCount));
  }
  // The others have nothing to return before they end.
  const bool improves =
      options.method == SamplingMethod::kLloyd || options.method == SamplingMethod::kCcvt;
  Interrupt improving = interrupt->Earlier(reserve);
  MethodControl control{improves ? &improving : interrupt};
  std::vector<Eigen::Vector3d> positions;
  control.on_step = [&](const MethodStep& step) {
    AlternationReport state;
    state.alternation = step.step;
    state.alternation_limit = options.max_iterations;
    state.energy = step.energy;
    state.max_displacement = step.max_move;
    positions.resize(step.points.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = step.points[i].position;
    state.positions = positions;
    report(state);
  };
  RelaxationReport at_once;
  at_once.termination = Termination::kConverged;
  switch (options.method) {
    case SamplingMethod::kCcst:
      break;
    case SamplingMethod::kWhiteNoise: {
      CCST_ASSIGN_OR_RETURN(const std::vector<SurfacePoint> points,
                            DrawWhiteNoise(surface, density, count, options.seed, control));
      Take(surface, points, samples);
      return at_once;
    }
    case SamplingMethod::kPoissonDisk: {
      CCST_ASSIGN_OR_RETURN(const DartSamples darts,
                            ThrowDarts(surface, density, count, options.seed, control));
      Take(surface, darts.points, samples);
      return at_once;
    }
    case SamplingMethod::kSampleElimination: {
      CCST_ASSIGN_OR_RETURN(const std::vector<SurfacePoint> points,
                            EliminateSamples(surface, density, count, options.seed, control));
      Take(surface, points, samples);
      return at_once;
    }
    case SamplingMethod::kLloyd: {
      CCST_ASSIGN_OR_RETURN(const RelaxedSamples relaxed,
                            RelaxLloyd(surface, density, count, options.seed,
                                       {.max_steps = options.max_iterations}, control));
      Take(surface, relaxed.points, samples);
      return Summarise(relaxed, &improving);
    }
    case SamplingMethod::kCcvt: {
      CCST_ASSIGN_OR_RETURN(const RelaxedSamples relaxed,
                            BalanceVoronoi(surface, density, count, options.seed,
                                           {.max_steps = options.max_iterations}, control));
      Take(surface, relaxed.points, samples);
      return Summarise(relaxed, &improving);
    }
  }
  return absl::InternalError("no such sampling method");
}

}  // namespace ccst::internal
