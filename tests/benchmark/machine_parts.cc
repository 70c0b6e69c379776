// What the machine can do at most, to hold the parts against: bandwidth of memory after the STREAM
// benchmark (McCalpin, 1995), and arithmetic without memory, both compiled as the core is.
#include <array>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

namespace ccst::benchmarks {
namespace {

/// a = b + scalar * c. Counts the bytes that the program asks for, 24 an element; a cache that
/// reads lines before it writes them moves 32.
void MachineTriad(benchmark::State& state) {
  const auto elements = static_cast<std::size_t>(state.range(0)) * 1024 / (3 * sizeof(double));
  std::vector<double> a(elements, 0.0);
  std::vector<double> b(elements, 1.0);
  std::vector<double> c(elements, 2.0);
  for (auto _ : state) {
    for (std::size_t i = 0; i < elements; ++i) a[i] = b[i] + 3.0 * c[i];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() *
                          static_cast<std::int64_t>(3 * sizeof(double) * elements));
}
// In the first cache, the second, the third, and far beyond all of them.
BENCHMARK(MachineTriad)->ArgName("KiB")->Arg(24)->Arg(384)->Arg(8 << 10)->Arg(256 << 10);

/// Loads that wait for each other, over a cycle through all of the memory: the latency.
void MachineChase(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0)) * 1024 / 64;
  struct alignas(64) Line {
    std::uint32_t next = 0;
  };
  std::vector<Line> lines(count);
  // A full-period generator modulo a power of two visits every line once and no two in a row that
  // a prefetcher would guess.
  for (std::size_t i = 0; i < count; ++i) {
    lines[i].next = static_cast<std::uint32_t>((i * 1'664'525 + 1'013'904'223) & (count - 1));
  }
  std::uint32_t at = 0;
  for (auto _ : state) benchmark::DoNotOptimize(at = lines[at].next);
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(MachineChase)->ArgName("KiB")->Arg(16)->Arg(256)->Arg(8 << 10)->Arg(256 << 10);

/// Independent multiplications and additions in registers. Items are operations: two a step and
/// lane.
void MachineMultiplyAdd(benchmark::State& state) {
  constexpr int kLanes = 24;
  constexpr int kSteps = 1024;
  std::array<double, kLanes> x;
  x.fill(1.0);
  double factor = 0.999;
  benchmark::DoNotOptimize(factor);
  for (auto _ : state) {
    for (int step = 0; step < kSteps; ++step) {
      for (double& lane : x) lane = lane * factor + 0.001;
    }
    benchmark::DoNotOptimize(x);
  }
  state.SetItemsProcessed(state.iterations() * 2 * kLanes * kSteps);
}
BENCHMARK(MachineMultiplyAdd);

/// One division after the other, each waiting for the one before.
void MachineDivide(benchmark::State& state) {
  double x = 1e300;
  double divisor = 1.0000001;
  benchmark::DoNotOptimize(divisor);
  for (auto _ : state) benchmark::DoNotOptimize(x = 1.5 + 1.0 / (x + divisor));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(MachineDivide);

}  // namespace
}  // namespace ccst::benchmarks
