#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/io/ply_header.h"
#include "core/io/text_cursor.h"

namespace ccst::io {
namespace {

// A value of the data part, as both kinds of file give it. `Read*` return empty where the file
// ends or, in text, where the token is no such number.
class TextValues {
 public:
  TextValues(std::string_view bytes, const PlyHeader& header)
      : cursor_(bytes.substr(header.data_offset), {}), first_line_(header.data_line) {}

  std::optional<double> ReadNumber(PlyType) { return ParseDouble(cursor_.Token()); }
  std::optional<std::int64_t> ReadInteger(PlyType) { return ParseInteger(cursor_.Token()); }
  bool Skip(PlyType, std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
      if (cursor_.Token().empty()) return false;
    }
    return true;
  }
  std::size_t remaining() const { return cursor_.remaining(); }
  std::string Where() const { return absl::StrCat("line ", first_line_ + cursor_.line() - 1); }
  // A digit and what separates it from the next.
  static std::size_t MinBytes(PlyType) { return 2; }
  // The last value needs nothing after it.
  static constexpr std::size_t kSlack = 1;

 private:
  TextCursor cursor_;
  std::int64_t first_line_;
};

class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, const PlyHeader& header)
      : bytes_(bytes), position_(header.data_offset), order_(header.order) {}

  std::optional<double> ReadNumber(PlyType type) {
    if (type == PlyType::kFloat64) return Load<double>();
    if (type == PlyType::kFloat32) {
      const auto value = Load<float>();
      if (!value.has_value()) return std::nullopt;
      return static_cast<double>(*value);
    }
    const auto value = ReadInteger(type);
    if (!value.has_value()) return std::nullopt;
    return static_cast<double>(*value);
  }
  // `type` must be an integer type.
  std::optional<std::int64_t> ReadInteger(PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return Load<std::int8_t>();
      case PlyType::kUint8:
        return Load<std::uint8_t>();
      case PlyType::kInt16:
        return Load<std::int16_t>();
      case PlyType::kUint16:
        return Load<std::uint16_t>();
      case PlyType::kInt32:
        return Load<std::int32_t>();
      case PlyType::kUint32:
        return Load<std::uint32_t>();
      case PlyType::kFloat32:
      case PlyType::kFloat64:
        break;
    }
    return std::nullopt;
  }
  bool Skip(PlyType type, std::int64_t count) {
    const std::size_t size = PlyTypeSize(type) * static_cast<std::size_t>(count);
    if (size > remaining()) return false;
    position_ += size;
    return true;
  }
  std::size_t remaining() const { return bytes_.size() - position_; }
  std::string Where() const { return absl::StrCat("byte ", position_); }
  static std::size_t MinBytes(PlyType type) { return PlyTypeSize(type); }
  static constexpr std::size_t kSlack = 0;

 private:
  template <typename T>
  std::optional<T> Load() {
    if (remaining() < sizeof(T)) return std::nullopt;
    const T value = LoadBytes<T>(bytes_.data() + position_, order_);
    position_ += sizeof(T);
    return value;
  }

  std::string_view bytes_;
  std::size_t position_;
  std::endian order_;
};

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
      } else {
        CCST_RETURN_IF_ERROR(SkipElement(element));
      }
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
      if (element.name == "tristrips" && element.count > 0) {
        return Unreadable("triangle strips are not supported; save the mesh with faces");
      }
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
    std::vector<int> axis_of(element.properties.size(), -1);
    int axes_found = 0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      for (int axis = 0; axis < 3; ++axis) {
        if (property.is_list || property.name != std::string(1, "xyz"[axis])) continue;
        axis_of[p] = axis;
        axes_found |= 1 << axis;
      }
    }
    if (axes_found != 7) return Unreadable("element 'vertex' needs the properties x, y and z");
    const auto where = [this] { return values_.Where(); };
    Eigen::Vector3d position;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (axis_of[p] < 0) {
          CCST_RETURN_IF_ERROR(SkipProperty(element, i, property));
          continue;
        }
        const auto value = values_.ReadNumber(property.type);
        if (!value.has_value()) return Broken(element, i, property);
        position[axis_of[p]] = *value;
      }
      CCST_RETURN_IF_ERROR(builder_.AddVertex(position, where));
    }
    return absl::OkStatus();
  }

  absl::Status ReadFaces(const PlyElement& element) {
    const auto is_corners = [](const PlyProperty& property) {
      return property.is_list && PlyTypeIsInteger(property.type) &&
             (property.name == "vertex_indices" || property.name == "vertex_index");
    };
    const auto corners_property =
        std::find_if(element.properties.begin(), element.properties.end(), is_corners);
    if (corners_property == element.properties.end()) {
      return Unreadable("element 'face' needs a list of integers named vertex_indices");
    }
    const auto where = [this] { return values_.Where(); };
    std::vector<std::int64_t> corners;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (&property != &*corners_property) {
          CCST_RETURN_IF_ERROR(SkipProperty(element, i, property));
          continue;
        }
        CCST_ASSIGN_OR_RETURN(const std::int64_t size, ReadListSize(element, i, property));
        corners.clear();
        for (std::int64_t k = 0; k < size; ++k) {
          const auto corner = values_.ReadInteger(property.type);
          if (!corner.has_value()) return Broken(element, i, property);
          corners.push_back(*corner);
        }
        CCST_RETURN_IF_ERROR(builder_.AddFace(corners, where));
      }
    }
    return absl::OkStatus();
  }

  Values values_;
  MeshBuilder builder_;
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
