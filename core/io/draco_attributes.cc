#include "core/io/draco_attributes.h"

#include <cstdint>
#include <memory>
#include <utility>

#include "core/io/draco_names.h"

namespace ccst::io {

using Type = draco::GeometryAttribute::Type;

Type DracoTypeOf(AttributeKind kind) {
  switch (kind) {
    case AttributeKind::kColor:
      return Type::COLOR;
    case AttributeKind::kTextureCoordinates:
      return Type::TEX_COORD;
    case AttributeKind::kScalar:
    case AttributeKind::kLabel:
      break;
  }
  return Type::GENERIC;
}

draco::PointAttribute* AddDracoAttribute(draco::PointCloud& cloud, Type type,
                                         draco::DataType data_type, int components,
                                         const std::string& name, const std::string& kind) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<std::int8_t>(components), data_type, false,
                 components * draco::DataTypeLength(data_type), 0);
  const int id = cloud.AddAttribute(attribute, /*identity_mapping=*/true, cloud.num_points());
  if (!name.empty() || !kind.empty()) {
    auto metadata = std::make_unique<draco::AttributeMetadata>();
    if (!name.empty()) metadata->AddEntryString(kDracoNameEntry, name);
    if (!kind.empty()) metadata->AddEntryString(kDracoKindEntry, kind);
    cloud.AddAttributeMetadata(id, std::move(metadata));
  }
  return cloud.attribute(id);
}

draco::PointAttribute* AddDracoAttribute(draco::PointCloud& cloud, const Attribute& attribute) {
  const bool is_label = attribute.kind == AttributeKind::kLabel;
  return AddDracoAttribute(cloud, DracoTypeOf(attribute.kind), draco::DT_FLOAT32,
                           attribute.components, attribute.name, is_label ? kDracoLabelKind : "");
}

}  // namespace ccst::io
