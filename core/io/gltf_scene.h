#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "absl/status/statusor.h"
#include "core/io/gltf_document.h"

namespace ccst::io {

/// A mesh of a glTF file where the scene has it.
struct GltfInstance {
  std::int64_t mesh = 0;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
};

/// What a scene shows, in the order of its nodes, and what of it is passed over.
struct GltfScene {
  std::vector<GltfInstance> instances;
  std::int64_t skinned_nodes = 0;  ///< Their meshes are taken as they are at rest.
};

/// The meshes of the default scene, else of the first one, else of all nodes, else each of the
/// file's meshes once. EXT_mesh_gpu_instancing gives a node's mesh once for each of its transforms.
/// @param max_instances  a file can ask for any number of them in a few bytes
/// @errors INVALID_ARGUMENT  MESH_UNREADABLE | LIMIT_EXCEEDED
/// @throws nlohmann::json::exception where a value has another type than it needs
absl::StatusOr<GltfScene> ReadGltfScene(const GltfDocument& document, std::int64_t max_instances);

}  // namespace ccst::io
