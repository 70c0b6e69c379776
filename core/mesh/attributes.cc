#include "core/mesh/attributes.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst {
namespace {

std::string Printable(std::string_view name) {
  std::string result(name.substr(0, kMaxAttributeName));
  std::replace_if(
      result.begin(), result.end(), [](char c) { return c < 0x20 || c > 0x7e; }, '_');
  return result;
}

const char* DefaultName(AttributeKind kind) {
  switch (kind) {
    case AttributeKind::kColor:
      return "color";
    case AttributeKind::kTextureCoordinates:
      return "uv";
    case AttributeKind::kLabel:
      return "label";
    case AttributeKind::kScalar:
      break;
  }
  return "scalar";
}

}  // namespace

void NameAttributes(std::vector<Attribute>& attributes) {
  std::set<std::string> taken;
  for (Attribute& attribute : attributes) {
    const std::string name =
        attribute.name.empty() ? DefaultName(attribute.kind) : Printable(attribute.name);
    attribute.name = name;
    for (int copy = 2; !taken.insert(attribute.name).second; ++copy) {
      const std::string suffix = absl::StrCat("_", copy);
      attribute.name = name.substr(0, kMaxAttributeName - suffix.size()) + suffix;
    }
  }
}

const Attribute* FindAttribute(const std::vector<Attribute>& attributes, std::string_view name) {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [name](const Attribute& a) { return a.name == name; });
  return found == attributes.end() ? nullptr : &*found;
}

std::size_t AttributeRows(const TriangleMesh& mesh, const Attribute& attribute) {
  return attribute.per_corner ? 3 * mesh.faces.size() : mesh.positions.size();
}

absl::Status CheckAttributes(const TriangleMesh& mesh) {
  constexpr int kMaxComponents = 4;
  if (mesh.attributes.size() > kMaxAttributes) {
    return OverLimit({"max_attribute_count", static_cast<std::int64_t>(kMaxAttributes),
                      static_cast<std::int64_t>(mesh.attributes.size())},
                     absl::StrCat("the mesh has ", mesh.attributes.size(), " attributes; at most ",
                                  kMaxAttributes, " are accepted"));
  }
  for (const Attribute& attribute : mesh.attributes) {
    const std::size_t rows = AttributeRows(mesh, attribute);
    const bool fits =
        attribute.components >= 1 && attribute.components <= kMaxComponents &&
        attribute.values.size() == rows * static_cast<std::size_t>(attribute.components);
    if (fits) continue;
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshDegenerate,
                     absl::StrCat("attribute '", attribute.name, "' has ", attribute.values.size(),
                                  " values in rows of ", attribute.components, "; there must be ",
                                  rows, " rows of 1 to ", kMaxComponents));
  }
  return absl::OkStatus();
}

}  // namespace ccst
