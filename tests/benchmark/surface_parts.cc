// What happens to a mesh before it is sampled, by the number of its faces.
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/density/density.h"
#include "core/io/draco_mesh.h"
#include "core/repair/repair.h"
#include "core/spatial/point_tree.h"
#include "core/spatial/spatial_order.h"
#include "core/surface/projection.h"
#include "core/surface/surface.h"
#include "tests/benchmark/subjects.h"

namespace ccst::benchmarks {
namespace {

constexpr std::int64_t kLeastFaces = 1000;
constexpr std::int64_t kMostFaces = 1'000'000;
constexpr std::int64_t kQueries = 4096;

void Sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("faces")->RangeMultiplier(10)->Range(kLeastFaces, kMostFaces);
  benchmark->Unit(benchmark::kMillisecond);
}

/// Searches are timed by the query.
void QuerySizes(benchmark::internal::Benchmark* benchmark) {
  Sizes(benchmark);
  benchmark->Unit(benchmark::kMicrosecond);
}

/// The surface of a scan and points near it in its unit frame, kept from one call to the next.
struct Place {
  explicit Place(std::int64_t faces)
      : surface(*Surface::Build(Scan(faces))),
        targets(PointsNear({surface.positions(), surface.faces()}, kQueries)) {
    for (std::int64_t i = 0; i < kQueries; ++i) {
      const auto vertex = static_cast<std::size_t>(static_cast<double>(i) * surface.vertex_count() /
                                                   static_cast<double>(kQueries));
      hosts.push_back(surface.outgoing()[vertex] / 3);
    }
  }

  Surface surface;
  std::vector<Eigen::Vector3d> targets;
  std::vector<std::int32_t> hosts;  // A face at the vertex that a target is near.
};

const Place& PlaceOf(std::int64_t faces) {
  static std::map<std::int64_t, std::unique_ptr<Place>> places;
  std::unique_ptr<Place>& place = places[faces];
  if (place == nullptr) place = std::make_unique<Place>(faces);
  return *place;
}

void RepairClean(benchmark::State& state) {
  const TriangleMesh mesh = Scan(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Repair(mesh));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.faces.size()));
}
BENCHMARK(RepairClean)->Apply(Sizes);

void RepairSoup(benchmark::State& state) {
  const TriangleMesh mesh = *MakeSubject("soup", state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Repair(mesh));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.faces.size()));
}
BENCHMARK(RepairSoup)->Apply(Sizes);

void SurfaceBuild(benchmark::State& state) {
  const TriangleMesh mesh = Scan(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Surface::Build(mesh));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.faces.size()));
}
BENCHMARK(SurfaceBuild)->Apply(Sizes);

void DracoDecode(benchmark::State& state) {
  const std::string bytes = *EncodeDraco(Scan(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(DecodeDraco(bytes));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(DracoDecode)->Apply(Sizes);

void ProjectionFollow(benchmark::State& state) {
  const Place& place = PlaceOf(state.range(0));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(place.surface.Follow(place.hosts[i], place.targets[i]));
    i = (i + 1) % kQueries;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ProjectionFollow)->Apply(QuerySizes);

void ProjectionSearch(benchmark::State& state) {
  const Place& place = PlaceOf(state.range(0));
  // As dense as for one sample a face. A negative tolerance makes every projection search.
  const double spacing = std::sqrt(place.surface.area() / place.surface.face_count());
  const Parallel parallel;
  Projection projection(&place.surface, spacing, &parallel);
  const auto project = [&](std::size_t i) {
    const std::int32_t face = place.hosts[i];
    const Eigen::Vector3d normal = place.surface.NormalAt(face, Eigen::Vector3d::Constant(1.0 / 3));
    return projection.Project(face, place.targets[i], normal, -1.0);
  };
  project(0);  // Builds the discretisation.
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(project(i));
    i = (i + 1) % kQueries;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ProjectionSearch)->Apply(QuerySizes);

/// The vertices of the surface as samples are stored.
std::vector<Eigen::Vector3d> PointsInOrder(const Place& place) {
  const std::vector<Eigen::Vector3d>& points = place.surface.positions();
  Interrupt none;
  std::vector<Eigen::Vector3d> sorted;
  for (const std::int32_t v : HilbertOrder(points, &none)) sorted.push_back(points[v]);
  return sorted;
}

void PointTreeBuild(benchmark::State& state) {
  const std::vector<Eigen::Vector3d> points = PointsInOrder(PlaceOf(state.range(0)));
  const Parallel parallel(static_cast<int>(state.range(1)));
  for (auto _ : state) benchmark::DoNotOptimize(PointTree(points, parallel));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(PointTreeBuild)
    ->ArgNames({"faces", "threads"})
    ->ArgsProduct({benchmark::CreateRange(kLeastFaces, kMostFaces, 10), {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void PointTreeNearest(benchmark::State& state) {
  const Place& place = PlaceOf(state.range(0));
  const std::vector<Eigen::Vector3d> points = PointsInOrder(place);
  const PointTree tree(points);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(tree.Nearest(place.targets[i], 1));
    i = (i + 1) % kQueries;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(PointTreeNearest)->Apply(QuerySizes);

void DensityEvaluation(benchmark::State& state) {
  const Place& place = PlaceOf(state.range(0));
  const Density density = *Density::Linear(
      place.surface, RisingValues({place.surface.positions(), place.surface.faces()}), 100.0);
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(1.0 / 3);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(density.At(place.hosts[i], middle));
    i = (i + 1) % kQueries;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(DensityEvaluation)->Apply(QuerySizes);

}  // namespace
}  // namespace ccst::benchmarks
