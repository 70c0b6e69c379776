#include "core/io/draco_cloud.h"

#include <cstddef>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "core/io/draco_attributes.h"
#include "core/mesh/attributes.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"

namespace ccst::io {
namespace {

using Type = draco::GeometryAttribute::Type;

void AddVectors(draco::PointCloud& cloud, Type type, const std::vector<Eigen::Vector3d>& vectors) {
  draco::PointAttribute* const out = AddDracoAttribute(cloud, type, draco::DT_FLOAT32, 3, "");
  for (std::uint32_t i = 0; i < vectors.size(); ++i) {
    const Eigen::Vector3f vector = vectors[i].cast<float>();
    out->SetAttributeValue(draco::AttributeValueIndex(i), vector.data());
  }
}

}  // namespace

absl::StatusOr<std::string> EncodeDracoCloud(const std::vector<Eigen::Vector3d>& positions,
                                             const std::vector<Eigen::Vector3d>& normals,
                                             const std::vector<Attribute>& attributes) {
  draco::PointCloud cloud;
  cloud.set_num_points(static_cast<std::uint32_t>(positions.size()));
  AddVectors(cloud, Type::POSITION, positions);
  if (!normals.empty()) AddVectors(cloud, Type::NORMAL, normals);
  std::vector<Attribute> named = attributes;
  NameAttributes(named);
  for (const Attribute& attribute : named) {
    draco::PointAttribute* const out = AddDracoAttribute(cloud, attribute);
    const auto width = static_cast<std::size_t>(attribute.components);
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      out->SetAttributeValue(draco::AttributeValueIndex(i), attribute.values.data() + width * i);
    }
  }
  draco::ExpertEncoder encoder(cloud);
  // The k-d tree method would reorder the points.
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) {
    return absl::InternalError(absl::StrCat("Draco encoder: ", status.error_msg_string()));
  }
  return std::string(buffer.data(), buffer.size());
}

}  // namespace ccst::io
