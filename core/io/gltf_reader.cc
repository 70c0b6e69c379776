#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/gltf_attributes.h"
#include "core/io/gltf_document.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

using Json = nlohmann::json;

constexpr char kDraco[] = "KHR_draco_mesh_compression";

// Extensions that change nothing of the shape, or that are read.
absl::Status CheckExtensions(const Json& json) {
  for (const Json& extension : json.value("extensionsRequired", Json::array())) {
    const std::string name = extension.get<std::string>();
    constexpr std::array<std::string_view, 6> kHarmless = {
        kDraco,         "KHR_mesh_quantization", "KHR_materials_",
        "KHR_texture_", "KHR_lights_",           "EXT_texture_"};
    const bool is_known = std::any_of(kHarmless.begin(), kHarmless.end(),
                                      [&](std::string_view k) { return name.starts_with(k); });
    if (!is_known) {
      return Unreadable(absl::StrCat("the file needs the extension ", Quoted(name),
                                     ", which is not supported; save it without"));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Eigen::Affine3d> TransformOf(const Json& node) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  const auto numbers = [&node](const char* key, auto& out) -> absl::StatusOr<bool> {
    const auto found = node.find(key);
    if (found == node.end()) return false;
    if (!found->is_array() || found->size() != out.size()) {
      return Unreadable(absl::StrCat("a node's '", key, "' needs ", out.size(), " numbers"));
    }
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (*found)[i].template get<double>();
    return true;
  };
  std::array<double, 16> matrix = {};
  CCST_ASSIGN_OR_RETURN(const bool has_matrix, numbers("matrix", matrix));
  if (has_matrix) {
    result.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix.data());
    return result;
  }
  std::array<double, 3> translation = {0, 0, 0};
  std::array<double, 4> rotation = {0, 0, 0, 1};
  std::array<double, 3> scale = {1, 1, 1};
  CCST_RETURN_IF_ERROR(numbers("translation", translation).status());
  CCST_RETURN_IF_ERROR(numbers("rotation", rotation).status());
  CCST_RETURN_IF_ERROR(numbers("scale", scale).status());
  result.translate(Eigen::Map<const Eigen::Vector3d>(translation.data()));
  // An identity is left out, so that exact coordinates stay exact.
  if (rotation != std::array<double, 4>{0, 0, 0, 1}) {
    result.rotate(
        Eigen::Quaterniond(rotation[3], rotation[0], rotation[1], rotation[2]).normalized());
  }
  result.scale(Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(scale.data())));
  return result;
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
    CCST_ASSIGN_OR_RETURN(std::vector<Visit> stack, Roots());
    std::vector<bool> seen(document_.json().value("nodes", Json::array()).size(), false);
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
      CCST_ASSIGN_OR_RETURN(const std::int64_t mesh, GltfInteger(*node, "mesh", -1));
      if (mesh >= 0) CCST_RETURN_IF_ERROR(AddMesh(mesh, transform));
      CCST_RETURN_IF_ERROR(Push(node->value("children", Json::array()), transform, stack));
    }
    return Finish();
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
      if (!node->is_number_unsigned()) return Unreadable("a node's number is none");
      stack.push_back({.node = node->get<std::int64_t>(), .parent = parent});
    }
    return absl::OkStatus();
  }

  // The nodes of the default scene, else of the first.
  absl::StatusOr<std::vector<Visit>> Roots() const {
    CCST_ASSIGN_OR_RETURN(const std::int64_t scene, GltfInteger(document_.json(), "scene", 0));
    CCST_ASSIGN_OR_RETURN(const Json* const json, document_.Element("scenes", scene));
    std::vector<Visit> stack;
    CCST_RETURN_IF_ERROR(
        Push(json->value("nodes", Json::array()), Eigen::Affine3d::Identity(), stack));
    return stack;
  }

  absl::Status AddMesh(std::int64_t index, const Eigen::Affine3d& transform) {
    CCST_ASSIGN_OR_RETURN(const Json* const mesh, document_.Element("meshes", index));
    const Json primitives = mesh->value("primitives", Json::array());
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const std::string where = absl::StrCat("mesh ", index, ", primitive ", i);
      auto part = ReadPrimitive(primitives[i]);
      if (!part.ok()) return WithPrefix(part.status(), where + ": ");
      CCST_RETURN_IF_ERROR(Append(*part, transform, where));
    }
    return absl::OkStatus();
  }

  // Empty for points and lines.
  absl::StatusOr<TriangleMesh> ReadPrimitive(const Json& primitive) const {
    constexpr std::int64_t kTriangles = 4;
    CCST_ASSIGN_OR_RETURN(const std::int64_t mode, GltfInteger(primitive, "mode", kTriangles));
    if (mode < kTriangles) return TriangleMesh{};
    if (mode > kTriangles) {
      return Unreadable("strips and fans are not supported; save it with triangles");
    }
    const Json attributes = primitive.value("attributes", Json::object());
    const Json extensions = primitive.value("extensions", Json::object());
    if (extensions.contains(kDraco)) return ReadDracoPrimitive(extensions[kDraco]);
    return ReadPlainPrimitive(primitive, attributes);
  }

  absl::StatusOr<TriangleMesh> ReadDracoPrimitive(const Json& extension) const {
    CCST_ASSIGN_OR_RETURN(const std::int64_t view, GltfInteger(extension, "bufferView", -1));
    CCST_ASSIGN_OR_RETURN(const std::string_view bytes, document_.BufferView(view));
    CCST_ASSIGN_OR_RETURN(TriangleMesh mesh, DecodeDraco(bytes, limits_));
    std::vector<Attribute> wanted;
    const Json ids = extension.value("attributes", Json::object());
    std::size_t width = 0;
    for (const auto& [key, _] : ids.items()) {
      const auto kind = KindOfGltfAttribute(key);
      if (!kind.has_value()) continue;
      CCST_ASSIGN_OR_RETURN(const std::int64_t id, GltfInteger(ids, key.c_str(), -1));
      const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                      [id](const Attribute& a) { return a.id == id; });
      if (found == mesh.attributes.end()) continue;
      width += static_cast<std::size_t>(found->components);
      CCST_RETURN_IF_ERROR(CheckGltfAttributes(wanted.size() + 1, width, 3 * mesh.faces.size(),
                                               limits_.max_decoded_bytes));
      Attribute& attribute = wanted.emplace_back(*found);
      attribute.name = key;
      attribute.kind = *kind;
    }
    mesh.attributes = std::move(wanted);
    return mesh;
  }

  absl::StatusOr<TriangleMesh> ReadPlainPrimitive(const Json& primitive,
                                                  const Json& attributes) const {
    CCST_ASSIGN_OR_RETURN(const std::int64_t position, GltfInteger(attributes, "POSITION", -1));
    if (position < 0) return Unreadable("there is no POSITION");
    CCST_ASSIGN_OR_RETURN(const GltfAccessor positions, document_.Accessor(position));
    if (positions.components != 3) return Unreadable("POSITION is not of type VEC3");
    TriangleMesh mesh;
    mesh.positions.reserve(static_cast<std::size_t>(positions.count));
    for (std::int64_t i = 0; i < positions.count; ++i) {
      mesh.positions.emplace_back(positions.At(i, 0), positions.At(i, 1), positions.At(i, 2));
    }
    CCST_RETURN_IF_ERROR(ReadFaces(primitive, mesh));
    CCST_RETURN_IF_ERROR(ReadAttributes(attributes, mesh));
    return mesh;
  }

  absl::Status ReadFaces(const Json& primitive, TriangleMesh& mesh) const {
    const auto vertices = static_cast<std::int64_t>(mesh.positions.size());
    CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(primitive, "indices", -1));
    std::optional<GltfAccessor> indices;
    if (index >= 0) {
      CCST_ASSIGN_OR_RETURN(indices, document_.Accessor(index));
      const bool is_unsigned = indices->component_type == 5121 || indices->component_type == 5123 ||
                               indices->component_type == 5125;
      if (indices->components != 1 || !is_unsigned) {
        return Unreadable("indices are not unsigned SCALARs");
      }
      indices->normalized = false;
    }
    const std::int64_t corners = indices.has_value() ? indices->count : vertices;
    if (corners % 3 != 0) {
      return Unreadable(absl::StrCat(corners, " corners do not make whole triangles"));
    }
    mesh.faces.reserve(static_cast<std::size_t>(corners / 3));
    for (std::int64_t c = 0; c < corners; c += 3) {
      Eigen::Vector3i face;
      for (int k = 0; k < 3; ++k) {
        const double vertex =
            indices.has_value() ? indices->At(c + k, 0) : static_cast<double>(c + k);
        if (vertex >= static_cast<double>(vertices)) {
          return Degenerate(absl::StrCat("face ", c / 3, " has a corner at vertex ", vertex,
                                         ", but there are ", vertices, " vertices (both counted ",
                                         "from 0)"));
        }
        face[k] = static_cast<int>(vertex);
      }
      mesh.faces.push_back(face);
    }
    return absl::OkStatus();
  }

  // By vertex and named by their keys. Matrices, which attributes cannot be, are passed over.
  absl::Status ReadAttributes(const Json& accessors, TriangleMesh& mesh) const {
    const std::size_t vertices = mesh.positions.size();
    std::size_t width = 0;
    for (const auto& [key, _] : accessors.items()) {
      const auto kind = KindOfGltfAttribute(key);
      if (!kind.has_value()) continue;
      CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(accessors, key.c_str(), -1));
      CCST_ASSIGN_OR_RETURN(const Json* const json, document_.Element("accessors", index));
      if (json->value("type", "").starts_with("MAT")) continue;
      CCST_ASSIGN_OR_RETURN(const GltfAccessor accessor, document_.Accessor(index));
      if (accessor.count != static_cast<std::int64_t>(vertices)) {
        return Unreadable(absl::StrCat(Quoted(key), " has ", accessor.count, " rows for ", vertices,
                                       " vertices"));
      }
      const auto components = static_cast<std::size_t>(accessor.components);
      width += components;
      CCST_RETURN_IF_ERROR(CheckGltfAttributes(mesh.attributes.size() + 1, width, vertices,
                                               limits_.max_decoded_bytes));
      Attribute& attribute = mesh.attributes.emplace_back(
          Attribute{.name = key, .kind = *kind, .components = accessor.components});
      attribute.values.reserve(components * vertices);
      for (std::int64_t i = 0; i < accessor.count; ++i) {
        for (int k = 0; k < accessor.components; ++k) {
          attribute.values.push_back(static_cast<float>(accessor.At(i, k)));
        }
      }
    }
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
    return WithPrefix(attributes_.Append(part, order, corners_before), where + ": ");
  }

  absl::StatusOr<MeshFile> Finish() {
    for (Attribute& attribute : std::move(attributes_).Finish(builder_.corners())) {
      builder_.AddAttribute(std::move(attribute));
    }
    return std::move(builder_).Finish();
  }

  const GltfDocument& document_;
  MeshLimits limits_;
  MeshBuilder builder_;
  GltfAttributes attributes_;
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
