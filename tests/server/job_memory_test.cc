// Holds what decoding, sampling and measuring take against what is estimated from the bytes alone,
// by counting every allocation of this process.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/io/draco_mesh.h"
#include "server/app/system.h"
#include "server/jobs/job_analyst.h"
#include "server/jobs/memory_estimate.h"
#include "server/meshes/measure_mesh.h"
#include "server/metrics/metrics.h"
#include "tests/server/fakes.h"
#include "tests/server/temp_folder.h"
#include "tests/support/heap_peak.h"
#include "tests/support/shapes.h"

namespace ccst::server {
namespace {

// What an estimate has for small things, whatever is asked for.
constexpr double kFixed = 8.0 * (1 << 20);

bool AllocationsAreCounted() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;
#else
  return true;
#endif
}

// Bytes that `action` has at its peak beside what there is now.
template <typename Action>
double PeakOf(const Action& action) {
  const std::int64_t before = CurrentHeapUse().now;
  ResetHeapPeak();
  action();
  return static_cast<double>(CurrentHeapUse().peak - before);
}

void ExpectWithin(double used, std::int64_t estimate, const std::string& what) {
  const auto estimated = static_cast<double>(estimate);
  EXPECT_LE(used, 1.5 * estimated) << what;
  EXPECT_LE(estimated, 1.5 * used + kFixed) << what;
}

TriangleMesh Torus(int cells) { return shapes::Torus(2.0, 0.7, cells, cells); }

TriangleMesh WithAttributes(TriangleMesh mesh, int count, int components, bool per_corner) {
  for (int a = 0; a < count; ++a) {
    Attribute attribute{
        .name = "a" + std::to_string(a), .components = components, .per_corner = per_corner};
    const std::size_t rows = per_corner ? 3 * mesh.faces.size() : mesh.positions.size();
    attribute.values.resize(rows * static_cast<std::size_t>(components));
    for (std::size_t i = 0; i < attribute.values.size(); ++i) {
      attribute.values[i] = static_cast<float>((i * 7 + static_cast<std::size_t>(a)) % 13 + 1);
    }
    mesh.attributes.push_back(std::move(attribute));
  }
  return mesh;
}

// One place in a hundred is a million times denser than the others.
TriangleMesh WithDensePlaces(TriangleMesh mesh) {
  Attribute attribute{.name = "density", .components = 1};
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    attribute.values.push_back(v % 97 == 0 ? 1.0F : 0.02F);
  }
  mesh.attributes.push_back(std::move(attribute));
  return mesh;
}

SamplingOptions Options(std::int64_t count, SamplingMethod method = SamplingMethod::kCcst) {
  SamplingOptions options;
  options.sample_count = count;
  options.method = method;
  options.max_iterations = 3;
  return options;
}

class JobMemory : public testing::Test {
 protected:
  void SetUp() override {
    if (!AllocationsAreCounted()) GTEST_SKIP() << "sanitizers have allocators of their own";
  }

  // What a job on `mesh` takes, from its stored bytes on, against the estimate from them.
  void ExpectJob(const TriangleMesh& mesh, const SamplingOptions& options,
                 const std::string& what) {
    const std::string stored = *EncodeDraco(mesh);
    const auto counts = CountDraco(SourceOf(stored), {});
    ASSERT_TRUE(counts.ok()) << counts.status();
    const double used = PeakOf([&] {
      TriangleMesh decoded;
      {
        const std::string bytes = stored;
        decoded = *DecodeDraco(bytes);
      }
      const auto result = SampleSurface(decoded, options);
      ASSERT_TRUE(result.ok()) << result.status();
    });
    ExpectWithin(used, EstimateJob({.mesh = *counts}, options), what);
  }
};

TEST_F(JobMemory, OfMeshesIsEstimated) {
  ExpectJob(Torus(250), Options(5000), "torus");
  ExpectJob(shapes::PlaneGrid(1.0, 1.0, 250, 250), Options(5000), "plane");
  ExpectJob(shapes::Unwelded(Torus(200)), Options(5000), "soup");
  ExpectJob(Torus(150), Options(60'000), "as many samples as faces");
}

TEST_F(JobMemory, OfAttributesIsEstimated) {
  ExpectJob(WithAttributes(Torus(150), 64, 4, false), Options(2000), "of vertices");
  ExpectJob(WithAttributes(Torus(80), 64, 4, true), Options(2000), "of corners");
  ExpectJob(WithAttributes(Torus(40), 64, 4, false), Options(40'000), "of samples");
}

TEST_F(JobMemory, OfMethodsIsEstimated) {
  for (const auto& [method, count] :
       {std::pair(SamplingMethod::kCcst, 100'000), std::pair(SamplingMethod::kWhiteNoise, 200'000),
        std::pair(SamplingMethod::kPoissonDisk, 40'000),
        std::pair(SamplingMethod::kSampleElimination, 40'000),
        std::pair(SamplingMethod::kLloyd, 40'000), std::pair(SamplingMethod::kCcvt, 4000)}) {
    ExpectJob(Torus(60), Options(count, method), std::to_string(static_cast<int>(method)));
  }
}

TEST_F(JobMemory, OfUnevenDensitiesIsEstimated) {
  for (const SamplingMethod method :
       {SamplingMethod::kCcst, SamplingMethod::kSampleElimination, SamplingMethod::kLloyd}) {
    SamplingOptions options = Options(20'000, method);
    options.density.source = DensitySource::kAttribute;
    options.density.attribute = "density";
    options.density.exponent = 4.0;
    options.density.max_contrast = 1e6;
    ExpectJob(WithDensePlaces(Torus(40)), options, std::to_string(static_cast<int>(method)));
  }
  SamplingOptions options = Options(5000);
  options.density.source = DensitySource::kCurvature;
  ExpectJob(Torus(250), options, "curvature");
}

TEST_F(JobMemory, OfUploadsIsEstimated) {
  for (const TriangleMesh& mesh :
       {Torus(250), shapes::Unwelded(Torus(150)), WithAttributes(Torus(100), 64, 4, true)}) {
    const std::string stored = *EncodeDraco(mesh);
    const double used = PeakOf([&] {
      TriangleMesh decoded;
      {
        const std::string bytes = stored;
        decoded = *DecodeDraco(bytes);
      }
      ASSERT_TRUE(MeasureMesh(decoded).ok());
    });
    ExpectWithin(used, EstimateUpload(*CountDraco(SourceOf(stored), {})), "upload");
  }
}

TEST_F(JobMemory, OfImagesIsEstimated) {
  constexpr std::int32_t kSide = 2048;
  const auto image = std::make_shared<Image>();
  image->width = kSide;
  image->height = kSide;
  TriangleMesh mesh = Torus(60);
  Attribute uv{.name = "uv", .kind = AttributeKind::kTextureCoordinates, .components = 2};
  for (const Eigen::Vector3d& position : mesh.positions) {
    uv.values.push_back(static_cast<float>(position.x() / 6.0 + 0.5));
    uv.values.push_back(static_cast<float>(position.y() / 6.0 + 0.5));
  }
  mesh.attributes.push_back(std::move(uv));
  const std::string stored = *EncodeDraco(mesh);
  InputCounts input = {.mesh = *CountDraco(SourceOf(stored), {})};
  input.image = {.width = kSide, .height = kSide, .decode_bytes = 4 * kSide * kSide};
  SamplingOptions options = Options(5000);
  options.density.source = DensitySource::kTexture;
  const double used = PeakOf([&] {
    image->values.assign(std::size_t{kSide} * kSide, 0.5F);
    options.density.image = image;
    const TriangleMesh decoded = *DecodeDraco(stored);
    ASSERT_TRUE(SampleSurface(decoded, options).ok());
  });
  ExpectWithin(used, EstimateJob(input, options), "texture");
}

// Runs a job in a store and measures its samples as AnalyzeJob does.
TEST_F(JobMemory, OfAnalysisIsEstimated) {
  for (const auto& [cells, count] : {std::pair(250, 2000), std::pair(60, 60'000)}) {
    const TempFolder folder;
    const auto store = *OpenEmbeddedStore(folder.Path("data"));
    BlobPins pins(*store);
    RunDependencies run = RealRunDependencies(SystemClock(), {});
    const auto budget = std::make_shared<MemoryBudget>(std::int64_t{4} << 30);
    Metrics observer;
    const auto jobs = *JobManager::Start(
        *store, pins, {},
        {.run = run, .new_id = CountingIds(), .observer = &observer, .budget = budget});
    JobSpec spec;
    spec.mesh_sha256 = *PutWhole(store->blobs(), *EncodeDraco(Torus(cells)));
    const BlobPins::Pin pin(pins, spec.mesh_sha256);
    spec.options = Options(count);
    const auto job = *jobs->Create(spec);
    ASSERT_TRUE(jobs->WaitUntilIdle(absl::Minutes(5)));
    JobAnalyst analyst(*jobs, store->blobs(), budget, run, 1, absl::Seconds(1));
    const InputCounts input = *CountInput(store->blobs(), job->spec(), run);
    const double used = PeakOf([&] { ASSERT_TRUE(analyst.Measure(*job, {}).ok()); });
    ExpectWithin(used, EstimateAnalysis(input, job->spec().options.density, count), "analysis");
  }
}

}  // namespace
}  // namespace ccst::server
