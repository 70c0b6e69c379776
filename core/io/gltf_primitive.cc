#include "core/io/gltf_primitive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/portable_math.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/gltf_attributes.h"
#include "core/io/gltf_constants.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

using Json = nlohmann::json;

// Corners of the i-th triangle among those of a primitive.
Eigen::Matrix<std::int64_t, 3, 1> CornersOf(std::int64_t mode, std::int64_t i) {
  if (mode == gltf::kTriangles) return {3 * i, 3 * i + 1, 3 * i + 2};
  if (mode == gltf::kTriangleFan) return {i + 1, i + 2, 0};
  return i % 2 == 0 ? Eigen::Matrix<std::int64_t, 3, 1>(i, i + 1, i + 2)
                    : Eigen::Matrix<std::int64_t, 3, 1>(i, i + 2, i + 1);
}

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfDocument& document, const Json& primitive, const MeshLimits& limits,
                  GltfIgnored& ignored)
      : document_(document),
        primitive_(primitive),
        attributes_(primitive.value("attributes", Json::object())),
        limits_(limits),
        ignored_(ignored) {}

  absl::StatusOr<TriangleMesh> Read() {
    CCST_ASSIGN_OR_RETURN(mode_, GltfInteger(primitive_, "mode", gltf::kTriangles));
    if (mode_ < gltf::kTriangles) {
      ++ignored_["primitives of points or lines"];
      return TriangleMesh{};
    }
    if (mode_ > gltf::kTriangleFan)
      return Unreadable(absl::StrCat("mode ", mode_, " is not known"));
    const auto targets =
        static_cast<std::int64_t>(primitive_.value("targets", Json::array()).size());
    if (targets > 0) ignored_["morph targets"] += targets;
    const Json extensions = primitive_.value("extensions", Json::object());
    if (extensions.contains(kDracoExtension)) {
      CCST_RETURN_IF_ERROR(ReadDraco(extensions[kDracoExtension]));
    } else {
      CCST_RETURN_IF_ERROR(ReadPositions());
      CCST_RETURN_IF_ERROR(ReadFaces());
      CCST_RETURN_IF_ERROR(ReadAttributes());
    }
    CCST_RETURN_IF_ERROR(MoveTexture());
    return std::move(mesh_);
  }

 private:
  // Whether the accessor of `key` says that its integers are fractions, and the integer that is 1.
  absl::StatusOr<std::optional<double>> FractionOf(const char* key) const {
    CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(attributes_, key, -1));
    // The stream is enough where there is no accessor.
    const auto found = document_.Element("accessors", index);
    if (!found.ok()) return std::nullopt;
    const Json* const accessor = *found;
    if (!accessor->value("normalized", false)) return std::nullopt;
    CCST_ASSIGN_OR_RETURN(const std::int64_t type, GltfInteger(*accessor, "componentType", 0));
    return GltfFullScale(static_cast<int>(type));
  }

  absl::Status ReadDraco(const Json& extension) {
    CCST_ASSIGN_OR_RETURN(const std::int64_t view, GltfInteger(extension, "bufferView", -1));
    CCST_ASSIGN_OR_RETURN(const std::string_view bytes, document_.BufferView(view));
    CCST_ASSIGN_OR_RETURN(mesh_, DecodeDraco(bytes, limits_));
    CCST_ASSIGN_OR_RETURN(const auto scale, FractionOf("POSITION"));
    if (scale.has_value()) {
      for (Eigen::Vector3d& position : mesh_.positions) {
        position = (position / *scale).cwiseMax(-1.0);
      }
    }
    std::vector<Attribute> wanted;
    const Json ids = extension.value("attributes", Json::object());
    std::size_t width = 0;
    for (const auto& [key, _] : ids.items()) {
      const auto kind = KindOfGltfAttribute(key);
      if (!kind.has_value()) continue;
      CCST_ASSIGN_OR_RETURN(const std::int64_t id, GltfInteger(ids, key.c_str(), -1));
      const auto found = std::find_if(mesh_.attributes.begin(), mesh_.attributes.end(),
                                      [id](const Attribute& a) { return a.id == id; });
      if (found == mesh_.attributes.end()) continue;
      width += static_cast<std::size_t>(found->components);
      CCST_RETURN_IF_ERROR(CheckGltfAttributes(wanted.size() + 1, width, 3 * mesh_.faces.size(),
                                               limits_.max_decoded_bytes));
      Attribute& attribute = wanted.emplace_back(*found);
      attribute.name = key;
      attribute.kind = *kind == AttributeKind::kScalar && attribute.kind == AttributeKind::kLabel
                           ? AttributeKind::kLabel
                           : *kind;
      CCST_ASSIGN_OR_RETURN(const auto full, FractionOf(key.c_str()));
      if (full.has_value()) ToFractions(*full, attribute);
    }
    mesh_.attributes = std::move(wanted);
    return absl::OkStatus();
  }

  // Draco's decoder has turned integers into fractions already where the stream itself says so.
  static void ToFractions(double full, Attribute& attribute) {
    const bool are_integers = std::any_of(attribute.values.begin(), attribute.values.end(),
                                          [](float value) { return std::abs(value) > 1.0f; });
    if (attribute.kind == AttributeKind::kLabel) attribute.kind = AttributeKind::kScalar;
    if (!are_integers) return;
    for (float& value : attribute.values) {
      value = std::max(-1.0f, static_cast<float>(value / full));
    }
  }

  absl::Status ReadPositions() {
    CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(attributes_, "POSITION", -1));
    if (index < 0) return Unreadable("there is no POSITION");
    CCST_ASSIGN_OR_RETURN(const GltfAccessor positions, document_.Accessor(index));
    if (positions.components != 3) return Unreadable("POSITION is not of type VEC3");
    if (positions.count > limits_.max_vertices) {
      return OverLimit(absl::StrCat(positions.count, " vertices; at most ", limits_.max_vertices,
                                    " are accepted"));
    }
    mesh_.positions.reserve(static_cast<std::size_t>(positions.count));
    for (std::int64_t i = 0; i < positions.count; ++i) {
      mesh_.positions.emplace_back(positions.At(i, 0), positions.At(i, 1), positions.At(i, 2));
    }
    return absl::OkStatus();
  }

  absl::Status ReadFaces() {
    const auto vertices = static_cast<std::int64_t>(mesh_.positions.size());
    CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(primitive_, "indices", -1));
    std::optional<GltfAccessor> indices;
    if (index >= 0) {
      CCST_ASSIGN_OR_RETURN(indices, document_.Accessor(index));
      const bool is_unsigned = indices->component_type == gltf::kUnsignedByte ||
                               indices->component_type == gltf::kUnsignedShort ||
                               indices->component_type == gltf::kUnsignedInt;
      if (indices->components != 1 || !is_unsigned) {
        return Unreadable("indices are not unsigned SCALARs");
      }
      indices->normalized = false;
    }
    const std::int64_t corners = indices.has_value() ? indices->count : vertices;
    if (mode_ == gltf::kTriangles && corners % 3 != 0) {
      return Unreadable(absl::StrCat(corners, " corners do not make whole triangles"));
    }
    if (corners > 3 * limits_.max_faces) {
      return OverLimit(absl::StrCat(corners, " corners of triangles; at most ", limits_.max_faces,
                                    " triangles are accepted"));
    }
    const std::int64_t faces =
        mode_ == gltf::kTriangles ? corners / 3 : std::max<std::int64_t>(corners - 2, 0);
    mesh_.faces.reserve(static_cast<std::size_t>(faces));
    for (std::int64_t f = 0; f < faces; ++f) {
      const auto of_face = CornersOf(mode_, f);
      Eigen::Vector3i face;
      for (int k = 0; k < 3; ++k) {
        const double vertex =
            indices.has_value() ? indices->At(of_face[k], 0) : static_cast<double>(of_face[k]);
        if (vertex >= static_cast<double>(vertices)) {
          return Degenerate(absl::StrCat("face ", f, " has a corner at vertex ", vertex,
                                         ", but there are ", vertices, " vertices (both counted ",
                                         "from 0)"));
        }
        face[k] = static_cast<int>(vertex);
      }
      mesh_.faces.push_back(face);
    }
    return absl::OkStatus();
  }

  // By vertex and named by their keys. What cannot be read is passed over: it may be of another
  // program, and nobody may have asked for it. Matrices, which attributes cannot be, are too.
  absl::Status ReadAttributes() {
    std::size_t width = 0;
    for (const auto& [key, _] : attributes_.items()) {
      const auto kind = KindOfGltfAttribute(key);
      if (!kind.has_value()) continue;
      auto accessor = OpenAttribute(key);
      if (!accessor.ok()) {
        ++ignored_[absl::StrCat("attributes ", Quoted(key), " (", accessor.status().message(),
                                ")")];
        continue;
      }
      width += static_cast<std::size_t>(accessor->components);
      CCST_RETURN_IF_ERROR(CheckGltfAttributes(mesh_.attributes.size() + 1, width,
                                               mesh_.positions.size(), limits_.max_decoded_bytes));
      Attribute& attribute = mesh_.attributes.emplace_back(
          Attribute{.name = key, .kind = *kind, .components = accessor->components});
      const bool is_label = *kind == AttributeKind::kScalar &&
                            accessor->component_type != gltf::kFloat && !accessor->normalized;
      if (is_label) attribute.kind = AttributeKind::kLabel;
      attribute.values.reserve(static_cast<std::size_t>(accessor->components * accessor->count));
      for (std::int64_t i = 0; i < accessor->count; ++i) {
        for (int k = 0; k < accessor->components; ++k) {
          attribute.values.push_back(static_cast<float>(accessor->At(i, k)));
        }
      }
    }
    return absl::OkStatus();
  }

  absl::StatusOr<GltfAccessor> OpenAttribute(const std::string& key) const {
    CCST_ASSIGN_OR_RETURN(const std::int64_t index, GltfInteger(attributes_, key.c_str(), -1));
    CCST_ASSIGN_OR_RETURN(GltfAccessor accessor, document_.Accessor(index));
    if (accessor.count == static_cast<std::int64_t>(mesh_.positions.size())) return accessor;
    return Unreadable(
        absl::StrCat("it has ", accessor.count, " rows for ", mesh_.positions.size(), " vertices"));
  }

  // The texture that a user calls the mesh's own is that of the base colour.
  absl::Status MoveTexture() {
    CCST_ASSIGN_OR_RETURN(const std::int64_t material, GltfInteger(primitive_, "material", -1));
    if (material < 0) return absl::OkStatus();
    CCST_ASSIGN_OR_RETURN(const Json* const json, document_.Element("materials", material));
    const Json texture = json->value("pbrMetallicRoughness", Json::object())
                             .value("baseColorTexture", Json::object());
    const Json extensions = texture.value("extensions", Json::object());
    const auto found = extensions.find("KHR_texture_transform");
    if (found == extensions.end()) return absl::OkStatus();
    CCST_ASSIGN_OR_RETURN(const std::int64_t own, GltfInteger(texture, "texCoord", 0));
    CCST_ASSIGN_OR_RETURN(const std::int64_t set, GltfInteger(*found, "texCoord", own));
    const auto pair = [&found](const char* key, double missing) {
      const Json numbers = found->value(key, Json::array({missing, missing}));
      return Eigen::Vector2d(numbers.at(0).get<double>(), numbers.at(1).get<double>());
    };
    const Eigen::Vector2d offset = pair("offset", 0.0);
    const Eigen::Vector2d scale = pair("scale", 1.0);
    const double rotation = found->value("rotation", 0.0);
    const double cosine = PortableCos(rotation);
    const double sine = PortableSin(rotation);
    const std::string key = absl::StrCat("TEXCOORD_", set);
    for (Attribute& attribute : mesh_.attributes) {
      if (attribute.name != key || attribute.components != 2) continue;
      for (std::size_t i = 0; i + 1 < attribute.values.size(); i += 2) {
        const double u = scale.x() * attribute.values[i];
        const double v = scale.y() * attribute.values[i + 1];
        attribute.values[i] = static_cast<float>(offset.x() + cosine * u + sine * v);
        attribute.values[i + 1] = static_cast<float>(offset.y() - sine * u + cosine * v);
      }
    }
    return absl::OkStatus();
  }

  const GltfDocument& document_;
  const Json& primitive_;
  Json attributes_;
  const MeshLimits& limits_;
  GltfIgnored& ignored_;
  std::int64_t mode_ = gltf::kTriangles;
  TriangleMesh mesh_;
};

}  // namespace

absl::StatusOr<TriangleMesh> ReadGltfPrimitive(const GltfDocument& document, const Json& primitive,
                                               const MeshLimits& limits, GltfIgnored& ignored) {
  return PrimitiveReader(document, primitive, limits, ignored).Read();
}

}  // namespace ccst::io
