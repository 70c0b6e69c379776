#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"

namespace ccst::server {

/// One attribute of a stored mesh.
struct MeshAttributeFacts {
  std::string name;
  int components = 1;
  double min_value = 0.0;
  double max_value = 0.0;
};

/// What is known of a stored mesh without decoding it again.
struct MeshFacts {
  std::int64_t vertices = 0;    ///< After repair.
  std::int64_t file_faces = 0;  ///< Host faces of samples are in [0, file_faces).
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  double area = 0.0;                                     ///< [mesh unit^2]
  Eigen::Vector3d bounds_min = Eigen::Vector3d::Zero();  ///< [mesh unit]
  Eigen::Vector3d bounds_max = Eigen::Vector3d::Zero();
  std::vector<MeshAttributeFacts> attributes;
  std::vector<std::string> warnings;
};

/// As bytes of a ccst.store.v1.MeshFacts, and back.
std::string EncodeFacts(const MeshFacts& facts);
/// @errors DATA_LOSS STORAGE_FAILED the bytes are none
absl::StatusOr<MeshFacts> DecodeFacts(const std::string& bytes);

}  // namespace ccst::server
