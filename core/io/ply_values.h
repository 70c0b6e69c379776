#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "core/io/numbers.h"
#include "core/io/ply_header.h"
#include "core/io/text_cursor.h"

namespace ccst::io {

// The data part of a PLY file, as both kinds of file give it. `Read*` return empty where the file
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

}  // namespace ccst::io
