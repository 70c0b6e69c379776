#pragma once

#include <string>

#include "core/mesh/triangle_mesh.h"
#include "draco/point_cloud/point_cloud.h"

namespace ccst::io {

/// How Draco calls attributes of that kind.
draco::GeometryAttribute::Type DracoTypeOf(AttributeKind kind);

/// Adds an attribute with one value a point to `cloud`, which may be a mesh; the caller fills it.
/// @param name  for the metadata; empty for none
/// @param kind  for the metadata, see kDracoKindEntry; empty for none
draco::PointAttribute* AddDracoAttribute(draco::PointCloud& cloud,
                                         draco::GeometryAttribute::Type type,
                                         draco::DataType data_type, int components,
                                         const std::string& name, const std::string& kind = "");

/// Adds an attribute of 32-bit floats for the values of `attribute`; the caller fills it.
draco::PointAttribute* AddDracoAttribute(draco::PointCloud& cloud, const Attribute& attribute);

}  // namespace ccst::io
