#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/status.h"
#include "client/cli/distinct_files.h"
#include "core/sampling/run_control.h"

namespace ccst::cli {

/// Checks that the stages of a run can be written into `folder`, which exists, and that none of
/// their files is one of `others`. @errors INVALID_ARGUMENT naming the path and what would be right
absl::Status CheckStageFiles(const std::string& folder, const std::vector<NamedFile>& others);

/// Writes the mesh of each stage of a run into a folder, as `1-repaired.ply` to `8-result.ply`.
/// Files of stages that the run does not come to stay as they were.
class StageFiles : public StageSink {
 public:
  /// @param origin  added to all positions [mesh unit].
  StageFiles(std::string folder, const Eigen::Vector3d& origin);

  void OnStage(Stage stage, std::span<const Eigen::Vector3d> positions,
               std::span<const Eigen::Vector3i> triangles) override;

  /// The first error of writing, after which nothing more is written.
  const absl::Status& status() const { return status_; }

 private:
  const std::string folder_;
  const Eigen::Vector3d origin_;
  absl::Status status_;
};

}  // namespace ccst::cli
