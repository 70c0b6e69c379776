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
      : document_(document), limits_(limits), builder_(limits) {}

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
    for (const char* const key : {"COLOR_0", "TEXCOORD_0"}) {
      CCST_ASSIGN_OR_RETURN(const std::int64_t id,
                            GltfInteger(extension.value("attributes", Json::object()), key, -1));
      for (Attribute& attribute : mesh.attributes) {
        if (id >= 0 && attribute.id == id) wanted.push_back(std::move(attribute));
      }
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
    CCST_RETURN_IF_ERROR(ReadAttribute(attributes, "COLOR_0", AttributeKind::kColor, 3, 4, mesh));
    CCST_RETURN_IF_ERROR(
        ReadAttribute(attributes, "TEXCOORD_0", AttributeKind::kTextureCoordinates, 2, 2, mesh));
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

  absl::Status ReadAttribute(const Json& attributes, const char* key, AttributeKind kind,
                             int least_components, int most_components, TriangleMesh& mesh) const {
    CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(attributes, key, -1));
    if (index < 0) return absl::OkStatus();
    CCST_ASSIGN_OR_RETURN(const GltfAccessor accessor, document_.Accessor(index));
    if (accessor.components < least_components || accessor.components > most_components ||
        accessor.count != static_cast<std::int64_t>(mesh.positions.size())) {
      return Unreadable(absl::StrCat(key, " has ", accessor.count, " rows of ", accessor.components,
                                     " for ", mesh.positions.size(), " vertices"));
    }
    Attribute attribute{.name = "", .kind = kind, .components = accessor.components};
    for (std::int64_t i = 0; i < accessor.count; ++i) {
      for (int k = 0; k < accessor.components; ++k) {
        attribute.values.push_back(static_cast<float>(accessor.At(i, k)));
      }
    }
    mesh.attributes.push_back(std::move(attribute));
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
    for (const Attribute& attribute : part.attributes) {
      AppendAttribute(part, attribute, order, corners_before);
    }
    return absl::OkStatus();
  }

  // By corner, because Draco has some by corner; white and (0, 0) where a part before had none.
  void AppendAttribute(const TriangleMesh& part, const Attribute& attribute,
                       const std::array<int, 3>& order, std::size_t corners_before) {
    const bool is_color = attribute.kind == AttributeKind::kColor;
    const auto width = static_cast<std::size_t>(attribute.components);
    if (is_color) {
      colors_.resize(4 * corners_before, 1.0F);
      has_alpha_ = has_alpha_ || width == 4;
    } else {
      uv_.resize(corners_before, Eigen::Vector2f::Zero());
    }
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      for (const int k : order) {
        const std::size_t row = attribute.per_corner ? 3 * f + static_cast<std::size_t>(k)
                                                     : static_cast<std::size_t>(part.faces[f][k]);
        const float* const value = attribute.values.data() + width * row;
        if (is_color) {
          colors_.insert(colors_.end(), {value[0], value[1], value[2], width == 4 ? value[3] : 1});
        } else {
          uv_.emplace_back(value[0], 1.0F - value[1]);  // glTF counts v from the top.
        }
      }
    }
  }

  absl::StatusOr<MeshFile> Finish() {
    if (!colors_.empty()) {
      colors_.resize(4 * builder_.corners(), 1.0F);
      Attribute color{.name = "color",
                      .kind = AttributeKind::kColor,
                      .components = has_alpha_ ? 4 : 3,
                      .per_corner = true};
      for (std::size_t i = 0; i < colors_.size(); ++i) {
        if (has_alpha_ || i % 4 < 3) color.values.push_back(colors_[i]);
      }
      builder_.AddAttribute(std::move(color));
    }
    if (!uv_.empty()) {
      uv_.resize(builder_.corners(), Eigen::Vector2f::Zero());
      builder_.AddCornerTexture(uv_);
    }
    return std::move(builder_).Finish();
  }

  const GltfDocument& document_;
  MeshLimits limits_;
  MeshBuilder builder_;
  std::vector<float> colors_;        // Four a corner, up to the last that has one.
  std::vector<Eigen::Vector2f> uv_;  // One a corner, up to the last that has one.
  bool has_alpha_ = false;
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
