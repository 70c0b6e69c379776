#include "core/io/glb_writer.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/draco_points.h"
#include "core/io/float_positions.h"
#include "core/io/gltf_constants.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"

namespace ccst::io {
namespace {

using Json = nlohmann::json;

Json ToJson(const Eigen::Vector3d& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

// The arrays of the file, one view and one accessor each.
class Arrays {
 public:
  // Takes what was appended to bytes() since the last call for rows of four-byte numbers; returns
  // the accessor's index.
  int Add(int component_type, int components, int target) {
    constexpr std::array<const char*, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const std::size_t size = bytes_.size() - start_;
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", start_}, {"byteLength", size}, {"target", target}});
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", component_type},
                          {"count", size / (4 * static_cast<std::size_t>(components))},
                          {"type", kTypes[static_cast<std::size_t>(components - 1)]}});
    start_ = bytes_.size();
    return static_cast<int>(accessors_.size()) - 1;
  }

  std::string& bytes() { return bytes_; }
  Json& accessors() { return accessors_; }
  const Json& views() const { return views_; }

 private:
  std::string bytes_;
  std::size_t start_ = 0;
  Json accessors_ = Json::array();
  Json views_ = Json::array();
};

// The keys of attributes in a primitive: those of a kind are counted, the others named.
class Keys {
 public:
  std::string Next(const Attribute& attribute) {
    switch (attribute.kind) {
      case AttributeKind::kColor:
        return absl::StrCat("COLOR_", colors_++);
      case AttributeKind::kTextureCoordinates:
        return absl::StrCat("TEXCOORD_", textures_++);
      case AttributeKind::kScalar:
      case AttributeKind::kLabel:
        break;
    }
    return absl::StrCat("_", attribute.name);
  }

 private:
  int colors_ = 0;
  int textures_ = 0;
};

int AddPositions(const std::vector<Eigen::Vector3d>& positions, const DracoPoints& points,
                 Arrays& arrays) {
  Eigen::AlignedBox3d box;
  for (const std::int32_t vertex : points.vertex) {
    const Eigen::Vector3d& position = positions[static_cast<std::size_t>(vertex)];
    box.extend(position);
    for (const double value : position) {
      AppendLittleEndian(arrays.bytes(), static_cast<float>(value));
    }
  }
  const int index = arrays.Add(gltf::kFloat, 3, gltf::kArrayBuffer);
  arrays.accessors().back()["min"] = ToJson(box.min());
  arrays.accessors().back()["max"] = ToJson(box.max());
  return index;
}

int AddAttribute(const Attribute& attribute, const DracoPoints& points, Arrays& arrays) {
  const auto width = static_cast<std::size_t>(attribute.components);
  const bool is_texture = attribute.kind == AttributeKind::kTextureCoordinates;
  for (std::size_t p = 0; p < points.count(); ++p) {
    const std::int64_t row = attribute.per_corner ? points.corner[p] : points.vertex[p];
    for (std::size_t k = 0; k < width; ++k) {
      float value = row < 0 ? 0.0F : attribute.values[width * static_cast<std::size_t>(row) + k];
      if (is_texture && k == 1) value = 1.0F - value;
      AppendLittleEndian(arrays.bytes(), std::isfinite(value) ? value : 0.0F);
    }
  }
  return arrays.Add(gltf::kFloat, attribute.components, gltf::kArrayBuffer);
}

std::string Describe(const Json& primitive, const Eigen::Vector3d& origin, Arrays& arrays) {
  Json node = {{"mesh", 0}};
  if (!origin.isZero(0.0)) node["translation"] = ToJson(origin);
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "ccst"}};
  document["scene"] = 0;
  document["scenes"].push_back({{"nodes", Json::array({0})}});
  document["nodes"].push_back(node);
  document["meshes"].push_back({{"primitives", Json::array({primitive})}});
  document["accessors"] = arrays.accessors();
  document["bufferViews"] = arrays.views();
  document["buffers"].push_back({{"byteLength", arrays.bytes().size()}});
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');  // Chunks are aligned to four bytes.
  return text;
}

}  // namespace

absl::StatusOr<std::string> EncodeGlb(const TriangleMesh& mesh) {
  if (mesh.positions.empty()) return Empty("the mesh has no vertices; glTF needs one");
  const Eigen::Vector3d origin = ChooseOrigin(mesh);
  CCST_ASSIGN_OR_RETURN(const std::vector<Eigen::Vector3d> relative,
                        ToFloatPositions(mesh.positions, origin));
  std::vector<Attribute> attributes = mesh.attributes;
  NameAttributes(attributes);
  const DracoPoints points = SplitIntoPoints(mesh);
  Arrays arrays;
  Json primitive = {{"mode", mesh.faces.empty() ? gltf::kPoints : gltf::kTriangles}};
  primitive["attributes"]["POSITION"] = AddPositions(relative, points, arrays);
  Keys keys;
  for (const Attribute& attribute : attributes) {
    primitive["attributes"][keys.Next(attribute)] = AddAttribute(attribute, points, arrays);
  }
  if (!mesh.faces.empty()) {
    for (const std::uint32_t point : points.of_corner) AppendLittleEndian(arrays.bytes(), point);
    primitive["indices"] = arrays.Add(gltf::kUnsignedInt, 1, gltf::kElementArrayBuffer);
  }
  const std::string json = Describe(primitive, origin, arrays);
  const std::size_t total = 12 + 8 + json.size() + 8 + arrays.bytes().size();
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    return OverLimit(absl::StrCat(total, " bytes; a GLB file has at most 4294967295"));
  }
  std::string out;
  out.reserve(total);
  out += gltf::kMagic;
  AppendLittleEndian(out, std::uint32_t{2});
  AppendLittleEndian(out, static_cast<std::uint32_t>(total));
  AppendLittleEndian(out, static_cast<std::uint32_t>(json.size()));
  AppendLittleEndian(out, gltf::kJsonChunk);
  out += json;
  AppendLittleEndian(out, static_cast<std::uint32_t>(arrays.bytes().size()));
  AppendLittleEndian(out, gltf::kBinChunk);
  out += arrays.bytes();
  return out;
}

}  // namespace ccst::io
