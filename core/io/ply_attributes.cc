#include "core/io/ply_attributes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/mesh/attributes.h"

namespace ccst::io {
namespace {

using Names = std::vector<std::string_view>;

// Values that stand for one in a colour; 0 for types that colours do not have.
double ColorDivisor(PlyType type) {
  switch (type) {
    case PlyType::kUint8:
      return 255.0;
    case PlyType::kUint16:
      return 65535.0;
    case PlyType::kFloat32:
    case PlyType::kFloat64:
      return 1.0;
    default:
      return 0.0;
  }
}

class Finder {
 public:
  explicit Finder(const PlyElement& element) : properties_(element.properties) {
    layout_.columns.resize(properties_.size());
  }

  // The first number of that name that is nothing yet.
  std::optional<std::size_t> Find(std::string_view name) const {
    for (std::size_t p = 0; p < properties_.size(); ++p) {
      if (layout_.columns[p].use == PlyColumn::Use::kNone && !properties_[p].is_list &&
          properties_[p].name == name) {
        return p;
      }
    }
    return std::nullopt;
  }

  bool TakePosition() {
    for (int axis = 0; axis < 3; ++axis) {
      const auto found = Find(std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1));
      if (!found.has_value()) return false;
      layout_.columns[*found] = {.use = PlyColumn::Use::kPosition, .component = axis};
    }
    return true;
  }

  // An attribute of all `names`, of which the first `required` must be there; false when not.
  bool Take(const Names& names, std::size_t required, AttributeKind kind) {
    std::vector<std::size_t> found;
    for (const std::string_view name : names) {
      const auto property = Find(name);
      const bool usable = property.has_value() && (kind != AttributeKind::kColor ||
                                                   ColorDivisor(properties_[*property].type) > 0);
      if (!usable) break;
      found.push_back(*property);
    }
    if (found.size() < required) return false;
    Add(found, kind, "");
    return true;
  }

  // The numbers that are nothing yet, one attribute each.
  void TakeScalars() {
    constexpr std::array<std::string_view, 3> kNormal = {"nx", "ny", "nz"};
    for (std::size_t p = 0; p < properties_.size(); ++p) {
      const PlyProperty& property = properties_[p];
      const bool is_normal =
          std::find(kNormal.begin(), kNormal.end(), property.name) != kNormal.end();
      if (property.is_list || is_normal || layout_.columns[p].use != PlyColumn::Use::kNone) {
        continue;
      }
      Add({p}, PlyTypeIsInteger(property.type) ? AttributeKind::kLabel : AttributeKind::kScalar,
          property.name);
    }
  }

  PlyLayout& layout() { return layout_; }

 private:
  void Add(const std::vector<std::size_t>& columns, AttributeKind kind, const std::string& name) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const PlyType type = properties_[columns[k]].type;
      layout_.columns[columns[k]] = {
          .use = PlyColumn::Use::kAttribute,
          .attribute = layout_.attributes.size(),
          .component = static_cast<int>(k),
          .divisor = kind == AttributeKind::kColor ? ColorDivisor(type) : 1.0};
    }
    layout_.attributes.push_back(
        {.name = name, .kind = kind, .components = static_cast<int>(columns.size())});
  }

  const std::vector<PlyProperty>& properties_;
  PlyLayout layout_;
};

absl::StatusOr<PlyLayout> TakeAttributes(Finder& finder, std::size_t taken, const char* what) {
  for (const Names& names : {Names{"red", "green", "blue", "alpha"},
                             Names{"diffuse_red", "diffuse_green", "diffuse_blue"}}) {
    if (finder.Take(names, 3, AttributeKind::kColor)) break;
  }
  for (const Names& names : {Names{"texture_u", "texture_v"}, Names{"s", "t"}, Names{"u", "v"}}) {
    if (finder.Take(names, 2, AttributeKind::kTextureCoordinates)) break;
  }
  finder.TakeScalars();
  if (finder.layout().attributes.size() + taken > kMaxAttributes) {
    return OverLimit(absl::StrCat("the ", what, " have ", finder.layout().attributes.size(),
                                  " attributes; at most ", kMaxAttributes,
                                  " are accepted of vertices and faces together"));
  }
  return std::move(finder.layout());
}

}  // namespace

absl::StatusOr<PlyLayout> LayOutPlyVertices(const PlyElement& element) {
  Finder finder(element);
  if (!finder.TakePosition()) {
    return Unreadable("element 'vertex' needs the properties x, y and z");
  }
  return TakeAttributes(finder, 0, "vertices");
}

absl::StatusOr<PlyLayout> LayOutPlyFaces(const PlyElement& element, std::size_t taken) {
  Finder finder(element);
  CCST_ASSIGN_OR_RETURN(PlyLayout layout, TakeAttributes(finder, taken, "faces"));
  for (Attribute& attribute : layout.attributes) attribute.per_corner = true;
  return layout;
}

bool IsPlyCornerList(const PlyProperty& property) {
  return property.is_list && PlyTypeIsInteger(property.type) &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

bool IsPlyTextureList(const PlyProperty& property) {
  return property.is_list && property.name == "texcoord";
}

}  // namespace ccst::io
