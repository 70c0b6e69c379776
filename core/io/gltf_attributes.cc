#include "core/io/gltf_attributes.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/mesh/attributes.h"

namespace ccst::io {
namespace {

float Missing(AttributeKind kind) { return kind == AttributeKind::kColor ? 1.0F : 0.0F; }

// Colours may have alpha in some parts only.
int StoredComponents(const Attribute& attribute) {
  return attribute.kind == AttributeKind::kColor ? 4 : attribute.components;
}

bool Fits(const Attribute& attribute) {
  switch (attribute.kind) {
    case AttributeKind::kColor:
      return attribute.components == 3 || attribute.components == 4;
    case AttributeKind::kTextureCoordinates:
      return attribute.components == 2;
    case AttributeKind::kScalar:
    case AttributeKind::kLabel:
      break;
  }
  return attribute.components >= 1 && attribute.components <= 4;
}

void DropAlpha(Attribute& color) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < color.values.size(); ++i) {
    if (i % 4 < 3) color.values[kept++] = color.values[i];
  }
  color.values.resize(kept);
}

}  // namespace

std::optional<AttributeKind> KindOfGltfAttribute(std::string_view key) {
  if (key.starts_with("COLOR_")) return AttributeKind::kColor;
  if (key.starts_with("TEXCOORD_")) return AttributeKind::kTextureCoordinates;
  if (key.starts_with("_")) return AttributeKind::kScalar;
  return std::nullopt;
}

absl::Status CheckGltfAttributes(std::size_t attributes, std::size_t width, std::size_t rows,
                                 std::int64_t max_bytes) {
  if (attributes > kMaxAttributes) {
    return OverLimit(absl::StrCat("the mesh has more than ", kMaxAttributes,
                                  " attributes besides positions and normals"));
  }
  const auto most = static_cast<std::size_t>(max_bytes) / sizeof(float);
  if (rows == 0 || width <= most / rows) return absl::OkStatus();
  return OverLimit(absl::StrCat("attributes of ", width, " numbers in each of ", rows,
                                " rows take more than ", max_bytes, " bytes, the most accepted"));
}

absl::Status GltfAttributes::Check(const Attribute& attribute, std::size_t corners) const {
  const auto refuse = [&attribute](const std::string& why) {
    return Unreadable(absl::StrCat(Quoted(attribute.name), " has rows of ", attribute.components,
                                   " numbers; ", why));
  };
  if (!Fits(attribute)) return refuse("colours have 3 or 4, texture coordinates 2");
  const auto known = by_key_.find(attribute.name);
  const bool is_new = known == by_key_.end();
  if (!is_new && StoredComponents(known->second) != StoredComponents(attribute)) {
    return refuse(absl::StrCat("in a primitive before it has ", known->second.components));
  }
  std::size_t width = is_new ? static_cast<std::size_t>(StoredComponents(attribute)) : 0;
  for (const auto& [key, other] : by_key_)
    width += static_cast<std::size_t>(StoredComponents(other));
  return CheckGltfAttributes(by_key_.size() + (is_new ? 1 : 0), width, corners, max_bytes_);
}

absl::Status GltfAttributes::Append(const TriangleMesh& part, const std::array<int, 3>& order,
                                    std::size_t before,
                                    std::map<std::string, std::int64_t>& ignored) {
  for (const Attribute& attribute : part.attributes) {
    const absl::Status status = Check(attribute, before + 3 * part.faces.size());
    if (!status.ok()) {
      if (GetErrorReason(status) != ErrorReason::kMeshUnreadable) return status;
      ++ignored[absl::StrCat("attributes ", std::string(status.message()))];
      continue;
    }
    const auto width = static_cast<std::size_t>(attribute.components);
    const auto stored = static_cast<std::size_t>(StoredComponents(attribute));
    const bool is_texture = attribute.kind == AttributeKind::kTextureCoordinates;
    Attribute& whole =
        by_key_.try_emplace(attribute.name, Attribute{.name = "", .kind = attribute.kind})
            .first->second;
    // A key that names labels in one part and other numbers in another names numbers.
    if (whole.kind != attribute.kind) whole.kind = AttributeKind::kScalar;
    whole.components = std::max(whole.components, attribute.components);
    whole.values.resize(stored * before, Missing(attribute.kind));
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      for (const int k : order) {
        const std::size_t row = attribute.per_corner ? 3 * f + static_cast<std::size_t>(k)
                                                     : static_cast<std::size_t>(part.faces[f][k]);
        const auto value = attribute.values.begin() + static_cast<std::ptrdiff_t>(width * row);
        whole.values.insert(whole.values.end(), value, value + attribute.components);
        whole.values.resize(whole.values.size() + stored - width, 1.0F);
        // glTF counts v from the top.
        if (is_texture) whole.values.back() = 1.0F - whole.values.back();
      }
    }
  }
  return absl::OkStatus();
}

std::vector<Attribute> GltfAttributes::Finish(std::size_t corners) && {
  std::vector<Attribute> result;
  for (auto& [key, attribute] : by_key_) {
    attribute.values.resize(static_cast<std::size_t>(StoredComponents(attribute)) * corners,
                            Missing(attribute.kind));
    attribute.per_corner = true;
    switch (attribute.kind) {
      case AttributeKind::kColor:
        attribute.name = "color";
        if (attribute.components == 3) DropAlpha(attribute);
        break;
      case AttributeKind::kTextureCoordinates:
        attribute.name = "uv";
        break;
      case AttributeKind::kScalar:
      case AttributeKind::kLabel:
        attribute.name = key.substr(1);
        break;
    }
    result.push_back(std::move(attribute));
  }
  return result;
}

}  // namespace ccst::io
