#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/gltf_attributes.h"
#include "core/io/gltf_document.h"
#include "core/io/gltf_meshopt.h"
#include "core/io/gltf_primitive.h"
#include "core/io/gltf_scene.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

using Json = nlohmann::json;

// A few bytes can ask for any number; each takes memory before there is a face to count.
constexpr std::int64_t kMaxInstances = 1'000'000;

// Extensions that change nothing of the shape, or that are read.
absl::Status CheckExtensions(const Json& json) {
  for (const Json& extension : json.value("extensionsRequired", Json::array())) {
    const std::string name = extension.get<std::string>();
    constexpr std::array<std::string_view, 9> kHarmless = {
        kDracoExtension,         kMeshoptExtension, "EXT_mesh_gpu_instancing",
        "KHR_mesh_quantization", "KHR_materials_",  "KHR_texture_",
        "KHR_lights_",           "EXT_texture_",    "EXT_mesh_features"};
    const bool is_known = std::any_of(kHarmless.begin(), kHarmless.end(),
                                      [&](std::string_view k) { return name.starts_with(k); });
    if (!is_known) {
      return Unreadable(absl::StrCat("the file needs the extension ", Quoted(name),
                                     ", which is not supported; save it without"));
    }
  }
  return absl::OkStatus();
}

class GltfReader {
 public:
  GltfReader(const GltfDocument& document, const MeshLimits& limits)
      : document_(document),
        limits_(limits),
        builder_(limits),
        attributes_(limits.max_decoded_bytes) {}

  absl::StatusOr<MeshFile> Read() {
    CCST_RETURN_IF_ERROR(CheckExtensions(document_.json()));
    CCST_ASSIGN_OR_RETURN(const GltfScene scene, ReadGltfScene(document_, kMaxInstances));
    if (scene.skinned_nodes > 0) ignored_["skins"] = scene.skinned_nodes;
    for (const GltfInstance& instance : scene.instances) {
      CCST_RETURN_IF_ERROR(AddMesh(instance));
    }
    return Finish();
  }

 private:
  // A mesh that is shown again and again is read once.
  absl::Status AddMesh(const GltfInstance& instance) {
    if (instance.mesh != mesh_) {
      CCST_RETURN_IF_ERROR(ReadMesh(instance.mesh));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      CCST_RETURN_IF_ERROR(Append(parts_[i], instance.transform,
                                  absl::StrCat("mesh ", instance.mesh, ", primitive ", i)));
    }
    return absl::OkStatus();
  }

  absl::Status ReadMesh(std::int64_t index) {
    CCST_ASSIGN_OR_RETURN(const Json* const mesh, document_.Element("meshes", index));
    const Json primitives = mesh->value("primitives", Json::array());
    parts_.clear();
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      auto part = ReadGltfPrimitive(document_, primitives[i], limits_, ignored_);
      if (!part.ok()) {
        return WithPrefix(part.status(), absl::StrCat("mesh ", index, ", primitive ", i, ": "));
      }
      parts_.push_back(*std::move(part));
    }
    mesh_ = index;
    return absl::OkStatus();
  }

  absl::Status Append(const TriangleMesh& part, const Eigen::Affine3d& transform,
                      const std::string& where) {
    const std::int64_t first = builder_.vertices();
    const std::size_t corners_before = builder_.corners();
    const auto describe = [&where] { return where; };
    for (const Eigen::Vector3d& position : part.positions) {
      CCST_RETURN_IF_ERROR(builder_.AddVertex(transform * position, describe));
    }
    // A mirrored part is inside out; the specification turns its faces round.
    const std::array<int, 3> order = transform.linear().determinant() < 0.0
                                         ? std::array<int, 3>{0, 2, 1}
                                         : std::array<int, 3>{0, 1, 2};
    for (const Eigen::Vector3i& face : part.faces) {
      const std::array<std::int64_t, 3> corners = {first + face[order[0]], first + face[order[1]],
                                                   first + face[order[2]]};
      CCST_RETURN_IF_ERROR(builder_.AddFace(corners, describe));
    }
    return WithPrefix(attributes_.Append(part, order, corners_before, ignored_), where + ": ");
  }

  absl::StatusOr<MeshFile> Finish() {
    for (Attribute& attribute : std::move(attributes_).Finish(builder_.corners())) {
      builder_.AddAttribute(std::move(attribute));
    }
    for (const auto& [what, count] : ignored_) builder_.Ignore(absl::StrCat(count, " ", what));
    return std::move(builder_).Finish();
  }

  const GltfDocument& document_;
  MeshLimits limits_;
  MeshBuilder builder_;
  GltfAttributes attributes_;
  GltfIgnored ignored_;
  std::int64_t mesh_ = -1;           // The mesh read last,
  std::vector<TriangleMesh> parts_;  // and its primitives.
};

}  // namespace

absl::StatusOr<MeshFile> ReadGltf(std::string_view bytes, const MeshLimits& limits,
                                  const std::optional<std::string>& folder) {
  try {
    CCST_ASSIGN_OR_RETURN(const GltfDocument document, GltfDocument::Open(bytes, folder, limits));
    return GltfReader(document, limits).Read();
  } catch (const Json::exception& e) {
    return Unreadable(absl::StrCat("the JSON is damaged: ", e.what()));
  }
}

}  // namespace ccst::io
