// What is measured of ended jobs, on which surface, and in whose memory. The core is the real one.
#include "server/jobs/job_analyst.h"

#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "server/jobs/memory_estimate.h"
#include "server/rpc/analyze_job.h"
#include "tests/server/fakes.h"
#include "tests/server/temp_folder.h"
#include "tests/support/shapes.h"

namespace ccst::server {
namespace {

constexpr std::int64_t kSamples = 1000;
constexpr std::int64_t kFaces = 1000;
constexpr char kTorus[] = "torus";
constexpr char kPlane[] = "plane";

// [0, 1] x [0, 1]: the attribute `heat` is 16 where x > 1/2 and 1 elsewhere, texture coordinates
// are x and y.
TriangleMesh PlaneOfTwoHalves() {
  constexpr int kCells = 20;
  TriangleMesh mesh = shapes::PlaneGrid(1.0, 1.0, kCells, kCells);
  Attribute heat{.name = "heat", .per_corner = true};
  Attribute texture{.name = "uv",
                    .kind = AttributeKind::kTextureCoordinates,
                    .components = 2,
                    .per_corner = true};
  for (const Eigen::Vector3i& face : mesh.faces) {
    double x = 0.0;
    for (const int v : face) x += mesh.positions[v].x() / 3.0;
    for (const int v : face) {
      heat.values.push_back(x > 0.5 ? 16.0F : 1.0F);
      texture.values.push_back(static_cast<float>(mesh.positions[v].x()));
      texture.values.push_back(static_cast<float>(mesh.positions[v].y()));
    }
  }
  mesh.attributes = {heat, texture};
  return mesh;
}

DensityOptions Uniform() { return {}; }

DensityOptions Heat() {
  DensityOptions density;
  density.source = DensitySource::kAttribute;
  density.attribute = "heat";
  return density;
}

DensityOptions Picture() {
  DensityOptions density;
  density.source = DensitySource::kTexture;
  return density;
}

class JobAnalystTest : public testing::Test {
 protected:
  void SetUp() override {
    store_ = *OpenEmbeddedStore(folder_.Path("data"));
    pins_ = std::make_unique<BlobPins>(*store_);
    meshes_[kTorus] = shapes::Torus(1.0, 0.4, 25, 20);
    meshes_[kPlane] = PlaneOfTwoHalves();
    run_ = FakeDependencies(SampleSurface);
    run_.count = [](const ByteSource&, const MeshLimits&) -> absl::StatusOr<MeshCounts> {
      return MeshCounts{.vertices = kFaces / 2, .faces = kFaces};
    };
    run_.decode = [this](std::span<const char> bytes,
                         const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
      return meshes_.at(std::string(bytes.begin(), bytes.end()));
    };
    // Dark where x < 1/2.
    run_.decode_image = [](std::span<const char>) -> absl::StatusOr<Image> {
      Image image{.width = 20, .height = 1, .values = {}};
      for (int i = 0; i < image.width; ++i) image.values.push_back(i < 10 ? 0.0F : 0.9F);
      return image;
    };
    jobs_ = *JobManager::Start(*store_, *pins_, {},
                               {.run = run_, .new_id = CountingIds(), .observer = &observer_});
  }

  std::shared_ptr<Job> Run(SamplingMethod method, const DensityOptions& density = Uniform()) {
    JobSpec spec;
    spec.share = "caller";
    spec.mesh_sha256 =
        *PutWhole(store_->blobs(), density.source == DensitySource::kUniform ? kTorus : kPlane);
    spec.options.method = method;
    spec.options.sample_count = kSamples;
    spec.options.density = density;
    if (density.source == DensitySource::kTexture) {
      spec.texture_sha256 = *PutWhole(store_->blobs(), "image");
    }
    auto job = jobs_->Create(spec);
    EXPECT_TRUE(job.ok()) << job.status();
    jobs_->WaitUntilIdle(absl::InfiniteDuration());
    EXPECT_EQ((*job)->View().state, JobState::kSucceeded) << (*job)->View().error;
    return *job;
  }
  void LoseMesh(const Job& job) {
    ASSERT_TRUE(store_->blobs().Remove(job.spec().mesh_sha256).ok());
  }

  JobAnalyst Analyst(absl::Duration longest_wait = absl::ZeroDuration()) {
    return {*jobs_, store_->blobs(), budget_, run_, 1, longest_wait};
  }
  JobFigures Measure(const Job& job) {
    auto figures = Analyst().Measure(job, {});
    EXPECT_TRUE(figures.ok()) << figures.status();
    return *std::move(figures);
  }

  TempFolder folder_;
  SilentJobObserver observer_;
  std::map<std::string, TriangleMesh> meshes_;
  RunDependencies run_;
  const std::shared_ptr<MemoryBudget> budget_ =
      std::make_shared<MemoryBudget>(std::int64_t{1} << 30);
  std::unique_ptr<Store> store_;
  std::unique_ptr<BlobPins> pins_;
  std::unique_ptr<JobManager> jobs_;
};

double MeanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST_F(JobAnalystTest, PointsAloneAreMeasuredOnTheSampledMesh) {
  const JobFigures figures = Measure(*Run(SamplingMethod::kPoissonDisk));
  EXPECT_FALSE(figures.mesh.has_value());
  ASSERT_TRUE(figures.on_surface.has_value());
  EXPECT_FALSE(figures.on_surface->mesh.has_value());
  EXPECT_GT(figures.on_surface->effective_nyquist, 0.5);
  const analysis::Curve& radial = figures.on_surface->radial_mean;
  ASSERT_FALSE(radial.x.empty());
  for (std::size_t i = 0; radial.x[i] < 0.6; ++i) EXPECT_EQ(radial.y[i], 0.0) << radial.x[i];
}

TEST_F(JobAnalystTest, SampleMeshIsMeasuredOnTheSampledMeshToo) {
  const auto job = Run(SamplingMethod::kCcst);
  const JobFigures before = Measure(*job);
  ASSERT_TRUE(before.mesh.has_value());
  ASSERT_TRUE(before.on_surface.has_value());
  EXPECT_TRUE(before.on_surface->mesh.has_value());
  LoseMesh(*job);
  EXPECT_NE(Measure(*job).on_surface->radial_mean.y, before.on_surface->radial_mean.y);
}

// White noise has a radial mean of 1 under the density that made it, and more without it.
TEST_F(JobAnalystTest, DensityOfAnAttributeIsFollowed) {
  const auto job = Run(SamplingMethod::kWhiteNoise, Heat());
  const JobFigures figures = Measure(*job);
  ASSERT_TRUE(figures.on_surface.has_value());
  EXPECT_NEAR(MeanOf(figures.on_surface->radial_mean.y), 1.0, 0.1);
}

TEST_F(JobAnalystTest, DensityOfAnImageIsFollowed) {
  const auto job = Run(SamplingMethod::kWhiteNoise, Picture());
  const JobFigures figures = Measure(*job);
  ASSERT_TRUE(figures.on_surface.has_value());
  EXPECT_NEAR(MeanOf(figures.on_surface->radial_mean.y), 1.0, 0.1);
}

TEST_F(JobAnalystTest, LostMeshLeavesTheSampleMesh) {
  const auto job = Run(SamplingMethod::kCcst);
  LoseMesh(*job);
  const JobFigures figures = Measure(*job);
  EXPECT_TRUE(figures.mesh.has_value());
  ASSERT_TRUE(figures.on_surface.has_value());
  EXPECT_GT(figures.on_surface->effective_nyquist, 0.5);
}

TEST_F(JobAnalystTest, LostMeshOfPointsLeavesDistances) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  LoseMesh(*job);
  const JobFigures figures = Measure(*job);
  EXPECT_GT(figures.distances.relative_radius_same_side, 0.5);
  EXPECT_FALSE(figures.on_surface.has_value());
}

TEST_F(JobAnalystTest, LostMeshOfADensityLeavesAngles) {
  const auto job = Run(SamplingMethod::kCcst, Heat());
  LoseMesh(*job);
  const JobFigures figures = Measure(*job);
  ASSERT_TRUE(figures.mesh.has_value());
  EXPECT_GT(figures.mesh->angles.mean_smallest, 30.0);
  EXPECT_FALSE(figures.on_surface.has_value());
}

TEST_F(JobAnalystTest, ManyAtOnceGiveTheSameBits) {
  const auto job = Run(SamplingMethod::kCcst);
  JobAnalyst analyst = Analyst();
  std::vector<std::string> answers(4);
  {
    std::vector<std::jthread> callers;
    for (std::string& answer : answers) {
      callers.emplace_back(
          [&] { answer = ToProto(*analyst.Measure(*job, {})).SerializeAsString(); });
    }
  }
  EXPECT_EQ(answers, std::vector<std::string>(4, answers.front()));
}

TEST_F(JobAnalystTest, MemoryIsThatOfJobsAndGivenBack) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  std::int64_t used = 0;
  run_.decode = [&](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
    used = budget_->used_bytes();
    return meshes_.at(kTorus);
  };
  Measure(*job);
  const InputCounts input = {.mesh = {.vertices = kFaces / 2, .faces = kFaces}};
  EXPECT_EQ(used,
            EstimateAnalysis(input, job->spec().options.density, job->spec().options.sample_count));
  EXPECT_EQ(budget_->used_bytes(), 0);
}

TEST_F(JobAnalystTest, MemoryThatJobsHoldIsRefusedAfterTheWait) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  const auto held = budget_->Take(budget_->limit_bytes());
  const auto figures = Analyst(absl::ZeroDuration()).Measure(*job, {});
  EXPECT_EQ(figures.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorReason(figures.status()), ErrorReason::kQueueFull);
}

TEST_F(JobAnalystTest, WhatNeedsMoreThanThereEverIsIsNotToldToComeAgain) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  run_.count = [](const ByteSource&, const MeshLimits&) -> absl::StatusOr<MeshCounts> {
    return MeshCounts{.faces = std::int64_t{1} << 40};
  };
  const absl::Status refused = Analyst().Measure(*job, {}).status();
  EXPECT_TRUE(absl::IsInvalidArgument(refused));
  EXPECT_EQ(GetErrorReason(refused), ErrorReason::kLimitExceeded);
  ASSERT_TRUE(GetPassedLimit(refused).has_value());
  EXPECT_EQ(GetPassedLimit(refused)->name, "max_job_memory_bytes");
}

TEST_F(JobAnalystTest, StopEndsTheWaitForMemory) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  const auto held = budget_->Take(budget_->limit_bytes());
  std::stop_source stop;
  JobAnalyst analyst = Analyst(absl::Hours(1));
  absl::Status end;
  {
    std::jthread caller([&] { end = analyst.Measure(*job, stop.get_token()).status(); });
    stop.request_stop();
  }
  EXPECT_TRUE(absl::IsCancelled(end)) << end;
}

TEST_F(JobAnalystTest, LongestComputationBoundsMeasuringToo) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  run_.max_seconds = 1e-9;
  const absl::Status end = Analyst().Measure(*job, {}).status();
  EXPECT_EQ(end.code(), absl::StatusCode::kDeadlineExceeded) << end;
  EXPECT_EQ(GetErrorReason(end), ErrorReason::kTimeLimitExceeded);
  EXPECT_EQ(budget_->used_bytes(), 0);
}

TEST_F(JobAnalystTest, LongestComputationLeavesASlowDecoderBehind) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  Gate go;
  run_.decode = [&](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
    go.Wait();
    return meshes_.at(kTorus);
  };
  run_.max_seconds = 0.05;
  JobAnalyst analyst = Analyst();
  const absl::Status end = analyst.Measure(*job, {}).status();
  EXPECT_EQ(GetErrorReason(end), ErrorReason::kTimeLimitExceeded) << end;
  go.Open();
}

TEST_F(JobAnalystTest, StopLeavesTheDecoderBehindWithItsMemory) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  Gate decoding;
  Gate go;
  run_.decode = [&](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
    decoding.Open();
    go.Wait();
    return meshes_.at(kTorus);
  };
  std::stop_source stop;
  JobAnalyst analyst = Analyst();
  std::jthread canceller([&] {
    decoding.Wait();
    stop.request_stop();
  });
  EXPECT_TRUE(absl::IsCancelled(analyst.Measure(*job, stop.get_token()).status()));
  EXPECT_GT(budget_->used_bytes(), 0);
  go.Open();
  EXPECT_NE(budget_->TakeWithin(absl::Hours(1), budget_->limit_bytes()), nullptr);
}

TEST_F(JobAnalystTest, StopBeforeTheStartMeasuresNothing) {
  const auto job = Run(SamplingMethod::kPoissonDisk);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(absl::IsCancelled(Analyst().Measure(*job, stop.get_token()).status()));
}

}  // namespace
}  // namespace ccst::server
