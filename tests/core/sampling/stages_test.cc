// What a StageSink is shown.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "core/quality/mesh_topology.h"
#include "core/sampling/run_control.h"
#include "core/sampling/sampling.h"
#include "tests/core/sampling/sampling_test_util.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

constexpr std::int64_t kCount = 1000;

struct Shown {
  Stage stage;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3i> triangles;
};

class StageRecorder : public StageSink {
 public:
  void OnStage(Stage stage, std::span<const Eigen::Vector3d> positions,
               std::span<const Eigen::Vector3i> triangles) override {
    shown.push_back(
        {stage, {positions.begin(), positions.end()}, {triangles.begin(), triangles.end()}});
  }

  std::vector<Stage> Stages() const {
    std::vector<Stage> stages;
    for (const Shown& each : shown) stages.push_back(each.stage);
    return stages;
  }

  const Shown& At(Stage stage) const {
    return *std::find_if(shown.begin(), shown.end(),
                         [&](const Shown& each) { return each.stage == stage; });
  }

  std::vector<Shown> shown;
};

SamplingOptions StageOptions(SamplingMethod method = SamplingMethod::kCcst) {
  SamplingOptions options;
  options.sample_count = kCount;
  options.method = method;
  options.max_iterations = DefaultMaxIterations(method);
  return options;
}

// The cube [-1, 1]^3, away from the origin.
const Eigen::Vector3d kMiddle(10.0, 20.0, 30.0);
TriangleMesh OffsetCube() { return shapes::Moved(shapes::Cube(), kMiddle); }

// How far from the sides of the cube.
double DistanceToCube(const Eigen::Vector3d& p) {
  return std::abs((p - kMiddle).cwiseAbs().maxCoeff() - 1.0);
}

TEST(Stages, RunShowsAllOfThemInTheirOrder) {
  StageRecorder recorder;
  ASSERT_TRUE(SampleSurface(OffsetCube(), StageOptions(), {.stages = &recorder}).ok());
  const std::vector<Stage> expected = {Stage::kRepaired, Stage::kRefined, Stage::kInitial,
                                       Stage::kEarly,    Stage::kMended,  Stage::kConverged,
                                       Stage::kRelaxed,  Stage::kResult};
  EXPECT_EQ(recorder.Stages(), expected);
}

TEST(Stages, SmoothSurfaceIsNotRefined) {
  StageRecorder recorder;
  ASSERT_TRUE(SampleSurface(shapes::Icosphere(3), StageOptions(), {.stages = &recorder}).ok());
  const std::vector<Stage> stages = recorder.Stages();
  EXPECT_EQ(std::count(stages.begin(), stages.end(), Stage::kRefined), 0);
}

TEST(Stages, OtherMethodsHaveTheInputAndTheResult) {
  StageRecorder recorder;
  ASSERT_TRUE(
      SampleSurface(OffsetCube(), StageOptions(SamplingMethod::kLloyd), {.stages = &recorder})
          .ok());
  EXPECT_EQ(recorder.Stages(), (std::vector<Stage>{Stage::kRepaired, Stage::kResult}));
}

TEST(Stages, SurfaceIsShownBeforeAndAfterItIsRefined) {
  StageRecorder recorder;
  ASSERT_TRUE(
      SampleSurface(shapes::Unwelded(OffsetCube()), StageOptions(), {.stages = &recorder}).ok());
  EXPECT_EQ(recorder.At(Stage::kRepaired).positions.size(), 8u);
  EXPECT_EQ(recorder.At(Stage::kRepaired).triangles.size(), 12u);
  EXPECT_GT(recorder.At(Stage::kRefined).triangles.size(), 1000u);
}

TEST(Stages, EveryMeshLiesOnTheSurfaceInMeshUnits) {
  StageRecorder recorder;
  ASSERT_TRUE(SampleSurface(OffsetCube(), StageOptions(), {.stages = &recorder}).ok());
  for (const Shown& shown : recorder.shown) {
    for (const Eigen::Vector3d& p : shown.positions) EXPECT_LE(DistanceToCube(p), 1e-14 * 30.0);
  }
}

TEST(Stages, EveryMeshHasTheTopologyOfTheSurface) {
  StageRecorder recorder;
  ASSERT_TRUE(SampleSurface(OffsetCube(), StageOptions(), {.stages = &recorder}).ok());
  for (const Shown& shown : recorder.shown) {
    const quality::MeshTopology topology = quality::MeasureTopology(
        static_cast<std::int64_t>(shown.positions.size()), shown.triangles);
    EXPECT_EQ(topology.first_defect, "");
    EXPECT_EQ(topology.euler, 2);
    EXPECT_EQ(topology.unused_vertices, 0);
  }
}

TEST(Stages, LastIsTheResult) {
  StageRecorder recorder;
  const SamplingResult result = *SampleSurface(OffsetCube(), StageOptions(), {.stages = &recorder});
  EXPECT_EQ(recorder.shown.back().positions, result.samples.positions);
  EXPECT_EQ(recorder.shown.back().triangles, result.samples.triangles);
}

TEST(Stages, LookingOnChangesNothing) {
  StageRecorder recorder;
  const SamplingResult watched =
      *SampleSurface(OffsetCube(), StageOptions(), {.stages = &recorder});
  EXPECT_EQ(sampling_test::FindDifference(watched, *SampleSurface(OffsetCube(), StageOptions())),
            "");
}

TEST(Stages, StoppedRunShowsNothing) {
  std::stop_source source;
  source.request_stop();
  StageRecorder recorder;
  EXPECT_FALSE(
      SampleSurface(OffsetCube(), StageOptions(), {.stop = source.get_token(), .stages = &recorder})
          .ok());
  EXPECT_TRUE(recorder.shown.empty());
}

}  // namespace
}  // namespace ccst
