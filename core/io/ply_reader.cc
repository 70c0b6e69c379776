#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/io/ply_attributes.h"
#include "core/io/ply_header.h"
#include "core/io/ply_values.h"

namespace ccst::io {
namespace {

// Fewest bytes of one record: every value once, every list empty.
template <typename Values>
std::size_t MinRecordBytes(const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += Values::MinBytes(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

template <typename Values>
class PlyDataReader {
 public:
  PlyDataReader(Values values, const MeshLimits& limits)
      : values_(std::move(values)), builder_(limits) {}

  absl::StatusOr<MeshFile> Read(const PlyHeader& header) {
    CCST_RETURN_IF_ERROR(Announce(header));
    for (const PlyElement& element : header.elements) {
      CCST_RETURN_IF_ERROR(CheckCount(element));
      // Records without properties have no bytes and say nothing.
      if (element.properties.empty()) continue;
      if (element.name == "vertex") {
        CCST_RETURN_IF_ERROR(ReadVertices(element));
        builder_.SetVertexCount(builder_.vertices());
      } else if (element.name == "face") {
        CCST_RETURN_IF_ERROR(ReadFaces(element));
      } else if (element.name == "tristrips") {
        CCST_RETURN_IF_ERROR(ReadStrips(element));
      } else {
        CCST_RETURN_IF_ERROR(SkipElement(element));
      }
    }
    for (Attribute& attribute : layout_.attributes) builder_.AddAttribute(std::move(attribute));
    if (!corner_uv_.empty()) {
      PadCornerUv();
      builder_.AddCornerTexture(corner_uv_);
    }
    for (Attribute& attribute : face_layout_.attributes) {
      attribute.values.resize(builder_.corners() * static_cast<std::size_t>(attribute.components),
                              attribute.kind == AttributeKind::kColor ? 1.0f : 0.0f);
      builder_.AddAttribute(std::move(attribute));
    }
    return std::move(builder_).Finish(
        [](std::int64_t) { return std::string("in the 'face' element"); });
  }

 private:
  absl::Status Announce(const PlyHeader& header) {
    std::int64_t vertices = 0;
    std::int64_t faces = 0;
    for (const PlyElement& element : header.elements) {
      if (element.name == "vertex") vertices = element.count;
      if (element.name == "face") faces = element.count;
    }
    // The shortest records there can be: three one-byte values; a count and three of them.
    return builder_.Announce(vertices, faces, static_cast<std::int64_t>(values_.remaining()), 3, 4);
  }

  absl::Status CheckCount(const PlyElement& element) const {
    const std::size_t record = MinRecordBytes<Values>(element);
    const std::size_t left = values_.remaining() + Values::kSlack;
    if (record == 0 || static_cast<std::uint64_t>(element.count) <= left / record) {
      return absl::OkStatus();
    }
    return Unreadable(absl::StrCat(values_.Where(), ": announces ", element.count, " records of '",
                                   element.name, "' of at least ", record, " bytes each, but only ",
                                   values_.remaining(), " bytes are left"));
  }

  absl::Status Broken(const PlyElement& element, std::int64_t record,
                      const PlyProperty& property) const {
    const bool ended = values_.remaining() == 0;
    return Unreadable(absl::StrCat(
        values_.Where(), ended ? ": the file ends in " : ": bad value in ", element.name, " ",
        record, " of ", element.count, ", property ", Quoted(property.name)));
  }

  absl::StatusOr<std::int64_t> ReadListSize(const PlyElement& element, std::int64_t record,
                                            const PlyProperty& property) {
    const auto size = values_.ReadInteger(property.count_type);
    if (!size.has_value()) return Broken(element, record, property);
    const std::size_t room =
        (values_.remaining() + Values::kSlack) / Values::MinBytes(property.type);
    if (*size < 0 || static_cast<std::uint64_t>(*size) > room) {
      return Unreadable(absl::StrCat(values_.Where(), ": list ", Quoted(property.name), " of ",
                                     element.name, " ", record, " announces ", *size,
                                     " items; the bytes left hold at most ", room));
    }
    return *size;
  }

  absl::Status SkipProperty(const PlyElement& element, std::int64_t record,
                            const PlyProperty& property) {
    std::int64_t count = 1;
    if (property.is_list) {
      CCST_ASSIGN_OR_RETURN(count, ReadListSize(element, record, property));
    }
    if (!values_.Skip(property.type, count)) return Broken(element, record, property);
    return absl::OkStatus();
  }

  absl::Status SkipElement(const PlyElement& element) {
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        CCST_RETURN_IF_ERROR(SkipProperty(element, i, property));
      }
    }
    return absl::OkStatus();
  }

  absl::Status ReadVertices(const PlyElement& element) {
    if (builder_.vertices() > 0) return Unreadable("there are two elements 'vertex' with records");
    CCST_ASSIGN_OR_RETURN(layout_, LayOutPlyVertices(element));
    // Each value has a byte or more in the file, as CheckCount() made sure.
    for (Attribute& attribute : layout_.attributes) {
      attribute.values.resize(static_cast<std::size_t>(element.count * attribute.components));
    }
    const auto where = [this] { return values_.Where(); };
    Eigen::Vector3d position;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const PlyColumn& column = layout_.columns[p];
        if (column.use == PlyColumn::Use::kNone) {
          CCST_RETURN_IF_ERROR(SkipProperty(element, i, property));
          continue;
        }
        const auto value = values_.ReadNumber(property.type);
        if (!value.has_value()) return Broken(element, i, property);
        if (column.use == PlyColumn::Use::kPosition) {
          position[column.component] = *value;
        } else {
          Attribute& attribute = layout_.attributes[column.attribute];
          attribute.values[static_cast<std::size_t>(i * attribute.components + column.component)] =
              static_cast<float>(*value / column.divisor);
        }
      }
      CCST_RETURN_IF_ERROR(builder_.AddVertex(position, where));
    }
    return absl::OkStatus();
  }

  // Reads a list into `items`.
  template <typename T, typename ReadItem>
  absl::Status ReadList(const PlyElement& element, std::int64_t record, const PlyProperty& property,
                        const ReadItem& read, std::vector<T>& items) {
    CCST_ASSIGN_OR_RETURN(const std::int64_t size, ReadListSize(element, record, property));
    items.clear();
    for (std::int64_t k = 0; k < size; ++k) {
      const auto item = read(property.type);
      if (!item.has_value()) return Broken(element, record, property);
      items.push_back(static_cast<T>(*item));
    }
    return absl::OkStatus();
  }

  absl::Status ReadFaces(const PlyElement& element) {
    const auto corners_property =
        std::find_if(element.properties.begin(), element.properties.end(), IsPlyCornerList);
    if (corners_property == element.properties.end()) {
      return Unreadable("element 'face' needs a list of integers named vertex_indices");
    }
    const auto texture_property =
        std::find_if(element.properties.begin(), element.properties.end(), IsPlyTextureList);
    CCST_ASSIGN_OR_RETURN(face_layout_, LayOutPlyFaces(element, layout_.attributes.size()));
    // Faces of an element before have none of these values.
    for (Attribute& attribute : face_layout_.attributes) {
      attribute.values.resize(builder_.corners() * static_cast<std::size_t>(attribute.components),
                              attribute.kind == AttributeKind::kColor ? 1.0f : 0.0f);
    }
    std::vector<double> numbers(element.properties.size());
    const auto where = [this] { return values_.Where(); };
    const auto read_integer = [this](PlyType type) { return values_.ReadInteger(type); };
    const auto read_number = [this](PlyType type) { return values_.ReadNumber(type); };
    std::vector<std::int64_t> corners;
    std::vector<float> texture;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (auto property = element.properties.begin(); property != element.properties.end();
           ++property) {
        if (property == corners_property) {
          CCST_RETURN_IF_ERROR(ReadList(element, i, *property, read_integer, corners));
        } else if (property == texture_property) {
          CCST_RETURN_IF_ERROR(ReadList(element, i, *property, read_number, texture));
        } else if (const auto p = property - element.properties.begin();
                   face_layout_.columns[static_cast<std::size_t>(p)].use != PlyColumn::Use::kNone) {
          const auto value = values_.ReadNumber(property->type);
          if (!value.has_value()) return Broken(element, i, *property);
          numbers[static_cast<std::size_t>(p)] = *value;
        } else {
          CCST_RETURN_IF_ERROR(SkipProperty(element, i, *property));
        }
      }
      AddFaceValues(corners.size(), numbers);
      if (!texture.empty() && texture.size() == 2 * corners.size()) AddCornerUv(texture);
      CCST_RETURN_IF_ERROR(builder_.AddFace(corners, where));
    }
    return absl::OkStatus();
  }

  // Strips of triangles, of which every second one is turned over; -1 ends a strip. Each triangle
  // counts as a face.
  absl::Status ReadStrips(const PlyElement& element) {
    const auto where = [this] { return values_.Where(); };
    const auto read_integer = [this](PlyType type) { return values_.ReadInteger(type); };
    std::vector<std::int64_t> strip;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!IsPlyCornerList(property)) {
          CCST_RETURN_IF_ERROR(SkipProperty(element, i, property));
          continue;
        }
        CCST_RETURN_IF_ERROR(ReadList(element, i, property, read_integer, strip));
        std::size_t length = 0;  // Of the strip so far.
        for (std::size_t k = 0; k < strip.size(); ++k) {
          length = strip[k] == -1 ? 0 : length + 1;
          if (length < 3) continue;
          const bool is_turned = length % 2 == 0;
          const std::array<std::int64_t, 3> corners = {strip[is_turned ? k - 1 : k - 2],
                                                       strip[is_turned ? k - 2 : k - 1], strip[k]};
          CCST_RETURN_IF_ERROR(builder_.AddFace(corners, where));
        }
      }
    }
    return absl::OkStatus();
  }

  // Gives every corner of the face that is about to be added the face's values.
  void AddFaceValues(std::size_t corners, const std::vector<double>& numbers) {
    const std::size_t rows = corners < 3 ? 0 : 3 * (corners - 2);
    for (Attribute& attribute : face_layout_.attributes) {
      std::array<float, 4> row = {};
      const auto index = static_cast<std::size_t>(&attribute - face_layout_.attributes.data());
      for (std::size_t p = 0; p < numbers.size(); ++p) {
        const PlyColumn& column = face_layout_.columns[p];
        if (column.use != PlyColumn::Use::kAttribute || column.attribute != index) continue;
        row[static_cast<std::size_t>(column.component)] =
            static_cast<float>(numbers[p] / column.divisor);
      }
      for (std::size_t i = 0; i < rows; ++i) {
        attribute.values.insert(attribute.values.end(), row.begin(),
                                row.begin() + attribute.components);
      }
    }
  }

  // Untextured faces, which have an empty list, get zeros.
  void PadCornerUv() { corner_uv_.resize(builder_.corners(), Eigen::Vector2f::Zero()); }

  // Of the face that is about to be added.
  void AddCornerUv(const std::vector<float>& texture) {
    PadCornerUv();
    polygon_uv_.clear();
    for (std::size_t k = 0; k + 1 < texture.size(); k += 2) {
      polygon_uv_.emplace_back(texture[k], texture[k + 1]);
    }
    AppendFan<Eigen::Vector2f>(polygon_uv_, corner_uv_);
  }

  Values values_;
  MeshBuilder builder_;
  PlyLayout layout_;
  PlyLayout face_layout_;
  std::vector<Eigen::Vector2f> corner_uv_;
  std::vector<Eigen::Vector2f> polygon_uv_;
};

}  // namespace

absl::StatusOr<MeshFile> ReadPly(std::string_view bytes, const MeshLimits& limits) {
  CCST_ASSIGN_OR_RETURN(const PlyHeader header, ReadPlyHeader(bytes));
  if (header.ascii) {
    return PlyDataReader<TextValues>(TextValues(bytes, header), limits).Read(header);
  }
  return PlyDataReader<BinaryValues>(BinaryValues(bytes, header), limits).Read(header);
}

}  // namespace ccst::io
