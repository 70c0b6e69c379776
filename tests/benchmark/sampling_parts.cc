// The steps of the sampler, by the number of samples, on a scan with twice as many faces.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/interrupt.h"
#include "core/parallel/parallel.h"
#include "core/quality/distances.h"
#include "core/sampling/mesh/edge_flips.h"
#include "core/sampling/output/progressive_order.h"
#include "core/sampling/relax/geometry_phase.h"
#include "core/sampling/start/initial_mesh.h"
#include "core/sampling/start/initial_points.h"
#include "tests/benchmark/subjects.h"
#include "tests/core/sampling/sampling_test_util.h"

/// A function with a plain name, so that callgrind can be told to count what is in it alone.
extern "C" [[gnu::noinline]] void ccst_benchmark_pass(ccst::internal::GeometryPhase* geometry) {
  ccst::Interrupt never;
  benchmark::DoNotOptimize(geometry->Pass(&never));
}

namespace ccst::benchmarks {
namespace {

using sampling_test::MakeStart;
using sampling_test::Start;

constexpr std::int64_t kLeastSamples = 1000;
constexpr std::int64_t kMostSamples = 100'000;

void Counts(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("n")->RangeMultiplier(10)->Range(kLeastSamples, kMostSamples);
  benchmark->Unit(benchmark::kMillisecond);
}

/// As a run begins: `n` initial samples and their triangulation. Kept from one call to the next,
/// since making it takes longer than most of what is measured on it.
const Start& FreshStart(std::int64_t n) {
  static std::map<std::int64_t, std::unique_ptr<Start>> starts;
  std::unique_ptr<Start>& start = starts[n];
  if (start == nullptr) start = std::make_unique<Start>(*MakeStart(Scan(2 * n), n));
  return *start;
}

/// The samples and the mesh of a start after two passes with flips, which is how most passes of a
/// run find them; the rest is that of the fresh start.
struct Settled {
  internal::Samples samples;
  internal::SampleMesh mesh;
};

const Settled& SettledStart(std::int64_t n) {
  static std::map<std::int64_t, std::unique_ptr<Settled>> all;
  std::unique_ptr<Settled>& settled = all[n];
  if (settled != nullptr) return *settled;
  const Start& start = FreshStart(n);
  settled = std::make_unique<Settled>(Settled{start.samples, start.mesh});
  Interrupt never;
  internal::GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                                   &settled->mesh, &settled->samples, &sampling_test::kOneThread);
  geometry.Alternate(2, &never);
  return *settled;
}

void InitialPoints(benchmark::State& state) {
  const Start& start = FreshStart(state.range(0));
  Interrupt never;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        DrawInitialPoints(start.surface, start.density, start.plan, 0, &never));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(InitialPoints)->Apply(Counts);

void InitialMesh(benchmark::State& state) {
  const Start& start = FreshStart(state.range(0));
  Interrupt never;
  for (auto _ : state) {
    benchmark::DoNotOptimize(BuildInitialMesh(start.surface, start.plan, start.samples, &never));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(InitialMesh)->Apply(Counts);

/// One pass in which every sample is visited: a new phase has all of them active.
void GeometryPass(benchmark::State& state) {
  const Start& start = FreshStart(state.range(0));
  const Settled& settled = SettledStart(state.range(0));
  const Parallel parallel(static_cast<int>(state.range(1)));
  internal::SampleMesh mesh = settled.mesh;  // Passes leave it as it is.
  std::optional<internal::Samples> samples;
  std::optional<internal::GeometryPhase> geometry;
  for (auto _ : state) {
    state.PauseTiming();
    samples = settled.samples;
    geometry.emplace(&start.surface, &start.density, &start.plan, Energy::kTarget, &mesh, &*samples,
                     &parallel);
    state.ResumeTiming();
    ccst_benchmark_pass(&*geometry);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(GeometryPass)
    ->ArgNames({"n", "threads"})
    ->ArgsProduct({benchmark::CreateRange(kLeastSamples, 10 * kMostSamples, 10), {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The first topology phase, which has most to flip: edges as one pass over a fresh start left
/// them.
void Flips(benchmark::State& state) {
  const Start& start = FreshStart(state.range(0));
  internal::Samples samples = start.samples;
  internal::SampleMesh connected = start.mesh;
  Interrupt never;
  internal::GeometryPhase geometry(&start.surface, &start.density, &start.plan, Energy::kTarget,
                                   &connected, &samples, &sampling_test::kOneThread);
  geometry.Pass(&never);
  std::optional<internal::SampleMesh> mesh;
  std::int64_t flips = 0;
  for (auto _ : state) {
    state.PauseTiming();
    mesh = start.mesh;
    internal::EdgeFlips topology(&*mesh, &samples.position, &samples.normal);
    state.ResumeTiming();
    flips += topology.FlipAll();
  }
  state.SetItemsProcessed(flips);
}
BENCHMARK(Flips)->Apply(Counts);

void OrderProgressively(benchmark::State& state) {
  const Start& start = FreshStart(state.range(0));
  const internal::Samples& samples = SettledStart(state.range(0)).samples;
  const double spacing = quality::HexagonalSpacing(start.surface.area(), state.range(0));
  Interrupt never;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        internal::ProgressiveOrder(samples.position, samples.normal, {}, spacing, 0, &never));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(OrderProgressively)->Apply(Counts);

void ClosestSameSide(benchmark::State& state) {
  const internal::Samples& samples = SettledStart(state.range(0)).samples;
  for (auto _ : state) {
    benchmark::DoNotOptimize(quality::FindClosestSameSide(samples.position, samples.normal));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(ClosestSameSide)->Apply(Counts);

}  // namespace
}  // namespace ccst::benchmarks
