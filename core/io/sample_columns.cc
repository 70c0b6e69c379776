#include "core/io/sample_columns.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

std::string PlainName(const std::string& name) {
  std::string result = name.empty() ? "attribute" : name;
  std::replace_if(
      result.begin(), result.end(),
      [](char c) {
        const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 && c > 0;
        return !is_plain && c != '_' && c != '.' && c != '-';
      },
      '_');
  return result;
}

std::string ColumnName(const Attribute& attribute, std::size_t component) {
  constexpr std::array<const char*, 4> kColor = {"red", "green", "blue", "alpha"};
  constexpr std::array<const char*, 2> kTexture = {"s", "t"};
  if (attribute.kind == AttributeKind::kColor && component < kColor.size()) {
    return kColor[component];
  }
  if (attribute.kind == AttributeKind::kTextureCoordinates && component < kTexture.size()) {
    return kTexture[component];
  }
  const std::string name = PlainName(attribute.name);
  return attribute.components == 1 ? name : absl::StrCat(name, "_", component);
}

}  // namespace

std::vector<SampleColumn> LayOutColumns(const std::vector<Attribute>& attributes,
                                        std::set<std::string> taken) {
  std::vector<SampleColumn> columns;
  for (const Attribute& attribute : attributes) {
    if (attribute.per_corner) continue;
    for (std::size_t k = 0; k < static_cast<std::size_t>(attribute.components); ++k) {
      const std::string name = ColumnName(attribute, k);
      std::string unique = name;
      for (int copy = 2; !taken.insert(unique).second; ++copy) {
        unique = absl::StrCat(name, "_", copy);
      }
      columns.push_back({.name = std::move(unique), .attribute = &attribute, .component = k});
    }
  }
  return columns;
}

void AppendPlyProperties(std::string& out, const std::vector<SampleColumn>& columns) {
  for (const SampleColumn& column : columns) {
    absl::StrAppend(&out, "property ", NamesOf(column.type()).ply, " ", column.name, "\n");
  }
}

std::size_t BytesOf(const std::vector<SampleColumn>& columns) {
  std::size_t bytes = 0;
  for (const SampleColumn& column : columns) bytes += NamesOf(column.type()).bytes;
  return bytes;
}

void AppendValues(std::string& out, const std::vector<SampleColumn>& columns, std::size_t i) {
  for (const SampleColumn& column : columns) {
    if (column.type() == NumberType::kUint8) {
      AppendLittleEndian(out, ToByte(column.Value(i)));
    } else if (column.type() == NumberType::kInt32) {
      AppendLittleEndian(out, ToWhole(column.Value(i)));
    } else {
      AppendLittleEndian(out, column.Value(i));
    }
  }
}

std::int32_t ToWhole(float label) {
  if (std::isnan(label)) return 0;
  constexpr double kLowest = std::numeric_limits<std::int32_t>::min();
  constexpr double kHighest = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(std::round(double{label}), kLowest, kHighest));
}

std::uint8_t ToByte(float fraction) {
  if (std::isnan(fraction)) return 0;
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(fraction, 0.0f, 1.0f)));
}

}  // namespace ccst::io
