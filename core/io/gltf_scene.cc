#include "core/io/gltf_scene.h"

#include <array>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"

namespace ccst::io {
namespace {

using Json = nlohmann::json;

constexpr char kInstancing[] = "EXT_mesh_gpu_instancing";

using Translation = std::array<double, 3>;
using Rotation = std::array<double, 4>;  // x, y, z, w.
using Scale = std::array<double, 3>;

Eigen::Affine3d Compose(const Translation& translation, const Rotation& rotation,
                        const Scale& scale) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  result.translate(Eigen::Map<const Eigen::Vector3d>(translation.data()));
  // An identity is left out, so that exact coordinates stay exact.
  if (rotation != Rotation{0, 0, 0, 1}) {
    result.rotate(
        Eigen::Quaterniond(rotation[3], rotation[0], rotation[1], rotation[2]).normalized());
  }
  result.scale(Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(scale.data())));
  return result;
}

// Fills `out` with the numbers under `key`; false when there are none.
template <std::size_t N>
absl::StatusOr<bool> ReadNumbers(const Json& node, const char* key, std::array<double, N>& out) {
  const auto found = node.find(key);
  if (found == node.end()) return false;
  if (!found->is_array() || found->size() != N) {
    return Unreadable(absl::StrCat("a node's '", key, "' needs ", N, " numbers"));
  }
  for (std::size_t i = 0; i < N; ++i) out[i] = (*found)[i].get<double>();
  return true;
}

absl::StatusOr<Eigen::Affine3d> TransformOf(const Json& node) {
  std::array<double, 16> matrix = {};
  CCST_ASSIGN_OR_RETURN(const bool has_matrix, ReadNumbers(node, "matrix", matrix));
  if (has_matrix) {
    Eigen::Affine3d result = Eigen::Affine3d::Identity();
    result.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
    return result;
  }
  Translation translation = {0, 0, 0};
  Rotation rotation = {0, 0, 0, 1};
  Scale scale = {1, 1, 1};
  CCST_RETURN_IF_ERROR(ReadNumbers(node, "translation", translation).status());
  CCST_RETURN_IF_ERROR(ReadNumbers(node, "rotation", rotation).status());
  CCST_RETURN_IF_ERROR(ReadNumbers(node, "scale", scale).status());
  return Compose(translation, rotation, scale);
}

// The i-th row of an accessor, where there is one.
template <std::size_t N>
void ReadRow(const std::optional<GltfAccessor>& accessor, std::int64_t i,
             std::array<double, N>& out) {
  if (!accessor.has_value()) return;
  for (std::size_t k = 0; k < N; ++k) out[k] = accessor->At(i, static_cast<int>(k));
}

class SceneReader {
 public:
  SceneReader(const GltfDocument& document, std::int64_t max_instances)
      : document_(document), max_instances_(max_instances) {}

  absl::StatusOr<GltfScene> Read() {
    const Json& json = document_.json();
    const Json nodes = json.value("nodes", Json::array());
    CCST_ASSIGN_OR_RETURN(std::vector<Visit> stack, Roots(nodes));
    std::vector<bool> seen(nodes.size(), false);
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      CCST_ASSIGN_OR_RETURN(const Json* const node, document_.Element("nodes", visit.node));
      if (seen[static_cast<std::size_t>(visit.node)]) {
        return Unreadable(absl::StrCat("node ", visit.node, " is in the scene twice"));
      }
      seen[static_cast<std::size_t>(visit.node)] = true;
      CCST_ASSIGN_OR_RETURN(const Eigen::Affine3d own, TransformOf(*node));
      const Eigen::Affine3d transform = visit.parent * own;
      CCST_RETURN_IF_ERROR(AddNode(*node, transform));
      CCST_RETURN_IF_ERROR(Push(node->value("children", Json::array()), transform, stack));
    }
    if (nodes.empty()) {
      const auto meshes = static_cast<std::int64_t>(json.value("meshes", Json::array()).size());
      for (std::int64_t mesh = 0; mesh < meshes; ++mesh) {
        CCST_RETURN_IF_ERROR(Add(mesh, Eigen::Affine3d::Identity()));
      }
    }
    return std::move(scene_);
  }

 private:
  struct Visit {
    std::int64_t node = 0;
    Eigen::Affine3d parent = Eigen::Affine3d::Identity();
  };

  // So that the first of `nodes` is visited next.
  static absl::Status Push(const Json& nodes, const Eigen::Affine3d& parent,
                           std::vector<Visit>& stack) {
    for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
      if (!node->is_number_unsigned()) {
        return Unreadable("a node is named by something that is not a whole number");
      }
      stack.push_back({.node = node->get<std::int64_t>(), .parent = parent});
    }
    return absl::OkStatus();
  }

  absl::StatusOr<std::vector<Visit>> Roots(const Json& nodes) const {
    std::vector<Visit> stack;
    if (!document_.json().value("scenes", Json::array()).empty()) {
      CCST_ASSIGN_OR_RETURN(const std::int64_t scene, GltfInteger(document_.json(), "scene", 0));
      CCST_ASSIGN_OR_RETURN(const Json* const json, document_.Element("scenes", scene));
      CCST_RETURN_IF_ERROR(
          Push(json->value("nodes", Json::array()), Eigen::Affine3d::Identity(), stack));
      return stack;
    }
    // Without scenes, the nodes that are nobody's children are shown.
    std::vector<bool> is_child(nodes.size(), false);
    for (const Json& node : nodes) {
      for (const Json& child : node.value("children", Json::array())) {
        if (!child.is_number_unsigned()) continue;  // Push() refuses it.
        const auto index = child.get<std::uint64_t>();
        if (index < is_child.size()) is_child[index] = true;
      }
    }
    for (std::size_t i = nodes.size(); i-- > 0;) {
      if (!is_child[i]) stack.push_back({.node = static_cast<std::int64_t>(i)});
    }
    return stack;
  }

  absl::Status AddNode(const Json& node, const Eigen::Affine3d& transform) {
    CCST_ASSIGN_OR_RETURN(const std::int64_t mesh, GltfInteger(node, "mesh", -1));
    if (mesh < 0) return absl::OkStatus();
    if (node.contains("skin")) ++scene_.skinned_nodes;
    const Json extensions = node.value("extensions", Json::object());
    if (!extensions.contains(kInstancing)) return Add(mesh, transform);
    return AddInstances(mesh, transform,
                        extensions[kInstancing].value("attributes", Json::object()));
  }

  absl::Status AddInstances(std::int64_t mesh, const Eigen::Affine3d& transform,
                            const Json& attributes) {
    std::int64_t count = -1;
    const auto open = [&](const char* key,
                          int components) -> absl::StatusOr<std::optional<GltfAccessor>> {
      CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(attributes, key, -1));
      if (index < 0) return std::nullopt;
      CCST_ASSIGN_OR_RETURN(GltfAccessor accessor, document_.Accessor(index));
      if (accessor.components != components || (count >= 0 && accessor.count != count)) {
        return Unreadable(absl::StrCat(kInstancing, ": ", key, " has ", accessor.count, " rows of ",
                                       accessor.components, " numbers"));
      }
      count = accessor.count;
      return std::optional(std::move(accessor));
    };
    CCST_ASSIGN_OR_RETURN(const auto translations, open("TRANSLATION", 3));
    CCST_ASSIGN_OR_RETURN(const auto rotations, open("ROTATION", 4));
    CCST_ASSIGN_OR_RETURN(const auto scales, open("SCALE", 3));
    for (std::int64_t i = 0; i < count; ++i) {
      Translation translation = {0, 0, 0};
      Rotation rotation = {0, 0, 0, 1};
      Scale scale = {1, 1, 1};
      ReadRow(translations, i, translation);
      ReadRow(rotations, i, rotation);
      ReadRow(scales, i, scale);
      CCST_RETURN_IF_ERROR(Add(mesh, transform * Compose(translation, rotation, scale)));
    }
    return absl::OkStatus();
  }

  absl::Status Add(std::int64_t mesh, const Eigen::Affine3d& transform) {
    if (static_cast<std::int64_t>(scene_.instances.size()) >= max_instances_) {
      return OverLimit(
          absl::StrCat("the scene shows more than ", max_instances_, " meshes, the most accepted"));
    }
    scene_.instances.push_back({.mesh = mesh, .transform = transform});
    return absl::OkStatus();
  }

  const GltfDocument& document_;
  std::int64_t max_instances_;
  GltfScene scene_;
};

}  // namespace

absl::StatusOr<GltfScene> ReadGltfScene(const GltfDocument& document, std::int64_t max_instances) {
  return SceneReader(document, max_instances).Read();
}

}  // namespace ccst::io
