#include "core/io/draco_convert.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "core/io/draco_names.h"
#include "core/io/io_errors.h"
#include "core/mesh/attributes.h"

namespace ccst::io {
namespace {

using Type = draco::GeometryAttribute::Type;

// The text that the metadata of an attribute has under `entry`; empty when there is none.
std::string TextOf(const draco::Mesh& mesh, int id, const char* entry) {
  std::string text;
  const draco::AttributeMetadata* const metadata = mesh.GetAttributeMetadataByAttributeId(id);
  if (metadata != nullptr) metadata->GetEntryString(entry, &text);
  return text;
}

std::string NameOf(const draco::Mesh& mesh, int id) { return TextOf(mesh, id, kDracoNameEntry); }

// Whole numbers are labels, unless they say that they stand for fractions.
bool IsLabel(const draco::Mesh& mesh, int id) {
  const draco::PointAttribute& attribute = *mesh.attribute(id);
  if (TextOf(mesh, id, kDracoKindEntry) == kDracoLabelKind) return true;
  switch (attribute.data_type()) {
    case draco::DT_INT8:
    case draco::DT_UINT8:
    case draco::DT_INT16:
    case draco::DT_UINT16:
    case draco::DT_INT32:
    case draco::DT_UINT32:
    case draco::DT_INT64:
    case draco::DT_UINT64:
      return !attribute.normalized();
    default:
      return false;
  }
}

// The first components of a value as floats; false when they are no numbers. Draco itself reads
// what is of type bool as bool, whatever the bytes are, which may be anything.
bool ReadValue(const draco::PointAttribute& attribute, draco::AttributeValueIndex value,
               std::span<float> out) {
  if (value.value() >= attribute.size()) return false;
  if (attribute.data_type() != draco::DT_BOOL) {
    return attribute.ConvertValue<float>(value, static_cast<std::int8_t>(out.size()), out.data());
  }
  const std::uint8_t* const bytes = attribute.GetAddress(value);
  if (!attribute.IsAddressValid(bytes + out.size() - 1)) return false;
  std::transform(bytes, bytes + out.size(), out.begin(),
                 [](std::uint8_t byte) { return byte != 0 ? 1.0F : 0.0F; });
  return true;
}

// The vertex of every point: the value of the position it has or, in streams of ours that split
// vertices, the number of points before that were no further point of one.
class Vertices {
 public:
  Vertices(const draco::Mesh& mesh, const draco::PointAttribute& positions) {
    const draco::PointAttribute* splits = nullptr;
    for (int i = 0; i < mesh.num_attributes(); ++i) {
      const draco::PointAttribute& attribute = *mesh.attribute(i);
      if (attribute.attribute_type() == Type::GENERIC && attribute.num_components() == 1 &&
          attribute.data_type() == draco::DT_UINT8 && NameOf(mesh, i) == kDracoSplitsName) {
        splits_id_ = i;
        splits = &attribute;
      }
    }
    count_ = static_cast<std::int64_t>(positions.size());
    of_point_.resize(mesh.num_points());
    if (splits != nullptr) count_ = 0;
    for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
      of_point_[p.value()] = positions.mapped_index(p).value();
      if (splits == nullptr) continue;
      std::uint8_t is_same = 0;
      splits->ConvertValue<std::uint8_t>(splits->mapped_index(p), 1, &is_same);
      if (is_same == 0 || count_ == 0) ++count_;
      of_point_[p.value()] = count_ - 1;
    }
  }

  std::int64_t count() const { return count_; }
  std::int64_t Of(draco::PointIndex point) const { return of_point_[point.value()]; }
  /// The attribute that tells how vertices are split; -1 when there is none.
  int splits_id() const { return splits_id_; }
  bool is_split() const { return splits_id_ >= 0; }

 private:
  int splits_id_ = -1;
  std::int64_t count_ = 0;
  std::vector<std::int64_t> of_point_;
};

absl::Status FillPositions(const draco::Mesh& mesh, const draco::PointAttribute& positions,
                           const Vertices& vertices, TriangleMesh& result) {
  result.positions.resize(static_cast<std::size_t>(vertices.count()), Eigen::Vector3d::Zero());
  const auto fill = [&](std::int64_t vertex, draco::AttributeValueIndex value) -> absl::Status {
    Eigen::Vector3d& position = result.positions[static_cast<std::size_t>(vertex)];
    // Truth values are none either, and Draco would read any byte as one.
    if (positions.data_type() == draco::DT_BOOL ||
        !positions.ConvertValue<double, 3>(value, position.data())) {
      return NotDraco(absl::StrCat("position ", vertex, " is of a type that is no number"));
    }
    if (position.allFinite()) return absl::OkStatus();
    return Degenerate(
        absl::StrCat("vertex ", vertex, " (counted from 0) has a coordinate that is not finite"));
  };
  if (!vertices.is_split()) {
    for (std::int64_t v = 0; v < vertices.count(); ++v) {
      CCST_RETURN_IF_ERROR(fill(v, draco::AttributeValueIndex(static_cast<std::uint32_t>(v))));
    }
    return absl::OkStatus();
  }
  for (draco::PointIndex p(0); p < mesh.num_points(); ++p) {
    const draco::AttributeValueIndex value = positions.mapped_index(p);
    if (value.value() >= positions.size()) return NotDraco("a point has no position");
    CCST_RETURN_IF_ERROR(fill(vertices.Of(p), value));
  }
  return absl::OkStatus();
}

absl::Status FillFaces(const draco::Mesh& mesh, const Vertices& vertices, TriangleMesh& result) {
  result.faces.resize(mesh.num_faces());
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (int corner = 0; corner < 3; ++corner) {
      const draco::PointIndex point = mesh.face(face)[corner];
      const std::int64_t vertex = point < mesh.num_points() ? vertices.Of(point) : -1;
      if (vertex < 0 || vertex >= vertices.count()) {
        return Degenerate(absl::StrCat("face ", face.value(), " (counted from 0) has a corner ",
                                       "outside the ", vertices.count(), " vertices"));
      }
      result.faces[face.value()][corner] = static_cast<int>(vertex);
    }
  }
  return absl::OkStatus();
}

// Kind and name of an attribute that samples can carry; empty for those they cannot.
std::optional<Attribute> Describe(const draco::Mesh& mesh, int id) {
  const draco::PointAttribute& attribute = *mesh.attribute(id);
  Attribute result{.name = NameOf(mesh, id), .components = attribute.num_components()};
  result.id = static_cast<std::int32_t>(attribute.unique_id());
  if (result.components < 1 || result.components > 4) return std::nullopt;
  switch (attribute.attribute_type()) {
    case Type::COLOR:
      if (result.components < 3) break;
      result.kind = AttributeKind::kColor;
      return result;
    case Type::TEX_COORD:
      if (result.components != 2) break;
      result.kind = AttributeKind::kTextureCoordinates;
      return result;
    case Type::GENERIC:
      break;
    default:
      return std::nullopt;
  }
  if (IsLabel(mesh, id)) result.kind = AttributeKind::kLabel;
  if (result.name.empty()) result.name = absl::StrCat("attribute_", result.id);
  return result;
}

// Fills the values, by vertex where the points of every vertex agree and by corner where not.
absl::Status FillValues(const draco::Mesh& mesh, const draco::PointAttribute& source,
                        const Vertices& vertices, Attribute& attribute) {
  const auto width = static_cast<std::size_t>(attribute.components);
  // Colours in bytes that do not say that they are fractions are fractions all the same.
  const bool is_bytes = attribute.kind == AttributeKind::kColor &&
                        source.data_type() == draco::DT_UINT8 && !source.normalized();
  std::array<float, 4> row = {};
  const auto read = [&](draco::PointIndex point) {
    if (!ReadValue(source, source.mapped_index(point), std::span(row).first(width))) return false;
    if (is_bytes) {
      for (float& component : row) component /= 255.0f;
    }
    return true;
  };
  const auto unreadable = [&attribute] {
    return NotDraco(
        absl::StrCat("attribute '", attribute.name, "' has values that are no numbers"));
  };
  attribute.values.assign(width * static_cast<std::size_t>(vertices.count()), 0.0f);
  std::vector<bool> seen(static_cast<std::size_t>(vertices.count()), false);
  for (draco::PointIndex p(0); p < mesh.num_points() && !attribute.per_corner; ++p) {
    const std::int64_t vertex = vertices.Of(p);
    if (vertex < 0 || vertex >= vertices.count()) continue;
    if (!read(p)) return unreadable();
    const auto v = static_cast<std::size_t>(vertex);
    float* const value = attribute.values.data() + width * v;
    if (!seen[v]) std::copy_n(row.begin(), width, value);
    seen[v] = true;
    attribute.per_corner = std::memcmp(value, row.data(), width * sizeof(float)) != 0;
  }
  if (!attribute.per_corner) return absl::OkStatus();
  attribute.values.clear();
  attribute.values.reserve(3 * width * mesh.num_faces());
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& point : mesh.face(face)) {
      if (!read(point)) return unreadable();
      attribute.values.insert(attribute.values.end(), row.begin(), row.begin() + width);
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TriangleMesh> FromDraco(const draco::Mesh& mesh, const MeshLimits& limits) {
  const draco::PointAttribute* const positions = mesh.GetNamedAttribute(Type::POSITION);
  if (positions == nullptr) return NotDraco("the mesh has no position attribute");
  if (positions->num_components() != 3) {
    return NotDraco(absl::StrCat("positions have ", int{positions->num_components()},
                                 " components instead of 3"));
  }
  if (mesh.num_faces() == 0) return Empty("the mesh has no faces");
  const Vertices vertices(mesh, *positions);
  if (vertices.count() > limits.max_vertices) {
    return ccst::OverLimit({"max_vertex_count", limits.max_vertices, vertices.count()},
                           absl::StrCat("the mesh has ", vertices.count(), " vertices; at most ",
                                        limits.max_vertices, " are accepted"));
  }
  TriangleMesh result;
  CCST_RETURN_IF_ERROR(FillPositions(mesh, *positions, vertices, result));
  CCST_RETURN_IF_ERROR(FillFaces(mesh, vertices, result));
  for (int id = 0; id < mesh.num_attributes(); ++id) {
    if (id == vertices.splits_id()) continue;
    auto attribute = Describe(mesh, id);
    if (!attribute.has_value()) continue;
    if (result.attributes.size() == kMaxAttributes) {
      constexpr auto kMost = static_cast<std::int64_t>(kMaxAttributes);
      return ccst::OverLimit({"max_attribute_count", kMost, kMost + 1},
                             absl::StrCat("the mesh has more than ", kMaxAttributes,
                                          " attributes besides positions and normals"));
    }
    CCST_RETURN_IF_ERROR(FillValues(mesh, *mesh.attribute(id), vertices, *attribute));
    result.attributes.push_back(*std::move(attribute));
  }
  NameAttributes(result.attributes);
  return result;
}

}  // namespace ccst::io
