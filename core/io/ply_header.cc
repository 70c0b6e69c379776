#include "core/io/ply_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/io/text_cursor.h"

namespace ccst::io {
namespace {

// More than any file has; keeps what a hostile header can make us do per record small.
constexpr std::size_t kMaxElements = 100;
constexpr std::size_t kMaxProperties = 1000;

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypeNames = {{
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},
    {"float32", PlyType::kFloat32},
    {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64},
}};

absl::StatusOr<PlyType> ReadType(TextCursor& cursor) {
  const std::string_view token = cursor.TokenOnLine();
  for (const auto& [name, type] : kTypeNames) {
    if (name == token) return type;
  }
  return Unreadable(absl::StrCat(cursor.Where(), ": ", Quoted(token), " is not a PLY type"));
}

absl::Status ReadFormat(TextCursor& cursor, PlyHeader& header) {
  const std::string_view format = cursor.TokenOnLine();
  const std::string_view version = cursor.TokenOnLine();
  header.ascii = format == "ascii";
  header.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
  const bool known =
      header.ascii || format == "binary_little_endian" || format == "binary_big_endian";
  if (known && version == "1.0") return absl::OkStatus();
  return Unreadable(absl::StrCat(cursor.Where(), ": format ", Quoted(format), " version ",
                                 Quoted(version), "; known are ascii, binary_little_endian and ",
                                 "binary_big_endian, version 1.0"));
}

absl::Status ReadElement(TextCursor& cursor, PlyHeader& header) {
  PlyElement element;
  element.name = std::string(cursor.TokenOnLine());
  const std::string_view token = cursor.TokenOnLine();
  const auto count = ParseInteger(token);
  if (element.name.empty() || !count.has_value() || *count < 0) {
    return Unreadable(absl::StrCat(cursor.Where(), ": 'element' needs a name and a count, found ",
                                   Quoted(token)));
  }
  if (header.elements.size() == kMaxElements) {
    return Unreadable(absl::StrCat(cursor.Where(), ": more than ", kMaxElements, " elements"));
  }
  element.count = *count;
  header.elements.push_back(std::move(element));
  return absl::OkStatus();
}

absl::Status ReadProperty(TextCursor& cursor, PlyHeader& header) {
  if (header.elements.empty()) {
    return Unreadable(absl::StrCat(cursor.Where(), ": 'property' before any 'element'"));
  }
  PlyProperty property;
  TextCursor ahead = cursor;
  if (ahead.TokenOnLine() == "list") {
    cursor = ahead;
    property.is_list = true;
    CCST_ASSIGN_OR_RETURN(property.count_type, ReadType(cursor));
    if (!PlyTypeIsInteger(property.count_type)) {
      return Unreadable(absl::StrCat(cursor.Where(), ": a list's count must be an integer type"));
    }
  }
  CCST_ASSIGN_OR_RETURN(property.type, ReadType(cursor));
  property.name = std::string(cursor.TokenOnLine());
  std::vector<PlyProperty>& properties = header.elements.back().properties;
  if (properties.size() == kMaxProperties) {
    return Unreadable(absl::StrCat(cursor.Where(), ": more than ", kMaxProperties, " properties"));
  }
  properties.push_back(std::move(property));
  return absl::OkStatus();
}

}  // namespace

std::size_t PlyTypeSize(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 0;
}

bool PlyTypeIsInteger(PlyType type) {
  return type != PlyType::kFloat32 && type != PlyType::kFloat64;
}

absl::StatusOr<PlyHeader> ReadPlyHeader(std::string_view bytes) {
  TextCursor cursor(bytes, {});
  if (cursor.TokenOnLine() != "ply") return Unreadable("line 1: a PLY file starts with 'ply'");
  cursor.SkipLine();
  PlyHeader header;
  bool has_format = false;
  for (; !cursor.AtEnd(); cursor.SkipLine()) {
    const std::string_view keyword = cursor.TokenOnLine();
    if (keyword == "format") {
      CCST_RETURN_IF_ERROR(ReadFormat(cursor, header));
      has_format = true;
    } else if (keyword == "element") {
      CCST_RETURN_IF_ERROR(ReadElement(cursor, header));
    } else if (keyword == "property") {
      CCST_RETURN_IF_ERROR(ReadProperty(cursor, header));
    } else if (keyword == "end_header") {
      if (!has_format) return Unreadable("the header has no 'format' line");
      cursor.SkipLine();
      header.data_offset = cursor.position();
      header.data_line = cursor.line();
      return header;
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      return Unreadable(
          absl::StrCat(cursor.Where(), ": ", Quoted(keyword), " is not a PLY header line"));
    }
  }
  return Unreadable("the file ends before 'end_header'");
}

}  // namespace ccst::io
