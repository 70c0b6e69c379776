#include "server/formats/mesh_facts.h"

#include "ccst/store/v1/record.pb.h"
#include "core/base/status.h"
#include "server/formats/stored_message.h"
#include "server/formats/vectors.h"

namespace ccst::server {

std::string EncodeFacts(const MeshFacts& facts) {
  store::v1::MeshFacts message;
  message.set_format(internal::kFormat);
  message.set_vertices(facts.vertices);
  message.set_file_faces(facts.file_faces);
  message.set_components(facts.components);
  message.set_boundary_loops(facts.boundary_loops);
  message.set_area(facts.area);
  internal::Write(facts.bounds_min, *message.mutable_bounds_min());
  internal::Write(facts.bounds_max, *message.mutable_bounds_max());
  for (const MeshAttributeFacts& attribute : facts.attributes) {
    store::v1::AttributeFacts& entry = *message.add_attributes();
    entry.set_name(attribute.name);
    entry.set_components(attribute.components);
    entry.set_min_value(attribute.min_value);
    entry.set_max_value(attribute.max_value);
  }
  message.mutable_warnings()->Assign(facts.warnings.begin(), facts.warnings.end());
  return message.SerializeAsString();
}

absl::StatusOr<MeshFacts> DecodeFacts(const std::string& bytes) {
  store::v1::MeshFacts message;
  CCST_RETURN_IF_ERROR(internal::ParseStored(bytes, "facts of a mesh are", message));
  MeshFacts facts{.vertices = message.vertices(),
                  .file_faces = message.file_faces(),
                  .components = message.components(),
                  .boundary_loops = message.boundary_loops(),
                  .area = message.area(),
                  .bounds_min = internal::Read(message.bounds_min()),
                  .bounds_max = internal::Read(message.bounds_max()),
                  .attributes = {},
                  .warnings = {message.warnings().begin(), message.warnings().end()}};
  for (const store::v1::AttributeFacts& entry : message.attributes()) {
    facts.attributes.push_back({.name = entry.name(),
                                .components = entry.components(),
                                .min_value = entry.min_value(),
                                .max_value = entry.max_value()});
  }
  return facts;
}

}  // namespace ccst::server
