#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/io/text_cursor.h"

namespace ccst::io {
namespace {

std::string Found(std::string_view token) {
  return token.empty() ? "the end of the file" : Quoted(token);
}

absl::StatusOr<std::int64_t> ToCount(std::string_view token, const TextCursor& cursor,
                                     const char* what) {
  const auto value = ParseInteger(token);
  if (!value.has_value() || *value < 0) {
    return Unreadable(
        absl::StrCat(cursor.Where(), ": expected the number of ", what, ", found ", Found(token)));
  }
  return *value;
}

struct Keyword {
  bool has_texture = false;
  bool has_color = false;
  bool has_normal = false;
  std::string_view first_count;
};

// Passes the keyword. Some writers leave out the space after it, so that the first count may
// be what is left of the token.
absl::StatusOr<Keyword> ReadKeyword(TextCursor& cursor) {
  Keyword keyword;
  const std::string_view token = cursor.Token();
  std::string_view rest = token;
  const auto take = [&rest](std::string_view prefix) {
    const bool found = rest.starts_with(prefix);
    if (found) rest.remove_prefix(prefix.size());
    return found;
  };
  keyword.has_texture = take("ST");
  keyword.has_color = take("C");
  keyword.has_normal = take("N");
  if (!rest.starts_with("OFF")) {
    return Unreadable(absl::StrCat(cursor.Where(),
                                   ": an OFF file starts with OFF, COFF, NOFF or STOFF, not with ",
                                   Found(token)));
  }
  keyword.first_count = rest.substr(3);
  return keyword;
}

// The colours of COFF: three or four numbers at the end of a vertex' line, bytes or fractions.
class VertexColors {
 public:
  // Takes the rest of the line of the i-th vertex.
  void Read(std::int64_t i, bool has_normal, TextCursor& cursor) {
    std::array<double, 7> numbers = {};
    std::size_t count = 0;
    for (; count < numbers.size(); ++count) {
      const auto value = ParseDouble(cursor.TokenOnLine());
      if (!value.has_value()) break;
      numbers[count] = *value;
    }
    const std::size_t first = has_normal ? 3 : 0;
    if (count < first + 3) return;
    has_alpha_ = has_alpha_ || count > first + 3;
    values_.resize(static_cast<std::size_t>(4 * i), kNone);
    for (std::size_t k = 0; k < 4; ++k) {
      const bool given = first + k < count;
      values_.push_back(given ? static_cast<float>(numbers[first + k]) : kNone);
      largest_ = std::max(largest_, values_.back());
    }
  }

  // The attribute, white where there was no colour; empty when there was none at all.
  std::optional<Attribute> Finish(std::int64_t vertices) && {
    if (values_.empty()) return std::nullopt;
    values_.resize(static_cast<std::size_t>(4 * vertices), kNone);
    const int components = has_alpha_ ? 4 : 3;
    Attribute attribute{.name = "color", .kind = AttributeKind::kColor, .components = components};
    attribute.values.reserve(static_cast<std::size_t>(components * vertices));
    // Nothing says which it is; fractions end at 1.
    const float divisor = largest_ > 1.0f ? 255.0f : 1.0f;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (i % 4 < static_cast<std::size_t>(components)) {
        attribute.values.push_back(values_[i] == kNone ? 1.0f : values_[i] / divisor);
      }
    }
    return attribute;
  }

 private:
  static constexpr float kNone = -1.0f;

  std::vector<float> values_;  // Four a vertex.
  bool has_alpha_ = false;
  float largest_ = 0.0f;
};

}  // namespace

absl::StatusOr<MeshFile> ReadOff(std::string_view text, const MeshLimits& limits) {
  TextCursor cursor(text, {.comment = '#'});
  CCST_ASSIGN_OR_RETURN(const Keyword keyword, ReadKeyword(cursor));
  std::string_view first_count = keyword.first_count;
  if (first_count.empty()) first_count = cursor.Token();
  if (first_count == "BINARY") {
    return Unreadable("binary OFF is not supported; save it as text or as PLY");
  }
  CCST_ASSIGN_OR_RETURN(const std::int64_t vertices, ToCount(first_count, cursor, "vertices"));
  CCST_ASSIGN_OR_RETURN(const std::int64_t faces, ToCount(cursor.Token(), cursor, "faces"));
  cursor.SkipLine();  // The number of edges, which nobody needs and some leave out.

  MeshBuilder builder(limits);
  constexpr std::int64_t kVertexBytes = 6;  // "0 0 0\n"
  constexpr std::int64_t kFaceBytes = 8;    // "3 0 0 0\n"
  CCST_RETURN_IF_ERROR(builder.Announce(
      vertices, faces, static_cast<std::int64_t>(cursor.remaining()), kVertexBytes, kFaceBytes));
  const auto where = [&cursor] { return cursor.Where(); };
  VertexColors colors;

  for (std::int64_t i = 0; i < vertices; ++i) {
    Eigen::Vector3d position;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view token = cursor.Token();
      const auto value = ParseDouble(token);
      if (!value.has_value()) {
        return Unreadable(absl::StrCat(cursor.Where(), ": expected coordinate ",
                                       std::string(1, "xyz"[axis]), " of vertex ", i, " of ",
                                       vertices, ", found ", Found(token)));
      }
      position[axis] = *value;
    }
    CCST_RETURN_IF_ERROR(builder.AddVertex(position, where));
    if (keyword.has_color && !keyword.has_texture) colors.Read(i, keyword.has_normal, cursor);
    cursor.SkipLine();
  }

  builder.SetVertexCount(vertices);
  std::vector<std::int64_t> corners;
  for (std::int64_t i = 0; i < faces; ++i) {
    const std::string_view size_token = cursor.Token();
    const auto size = ParseInteger(size_token);
    // A corner takes two bytes at least.
    if (!size.has_value() || *size < 0 ||
        *size > static_cast<std::int64_t>(cursor.remaining() / 2 + 1)) {
      return Unreadable(absl::StrCat(cursor.Where(), ": expected the number of corners of face ", i,
                                     " of ", faces, ", found ", Found(size_token)));
    }
    corners.clear();
    for (std::int64_t k = 0; k < *size; ++k) {
      const std::string_view token = cursor.Token();
      const auto corner = ParseInteger(token);
      if (!corner.has_value()) {
        return Unreadable(absl::StrCat(cursor.Where(), ": expected corner ", k, " of ", *size,
                                       " of face ", i, ", found ", Found(token)));
      }
      corners.push_back(*corner);
    }
    CCST_RETURN_IF_ERROR(builder.AddFace(corners, where));
    cursor.SkipLine();
  }
  if (auto color = std::move(colors).Finish(vertices)) builder.AddAttribute(*std::move(color));
  return std::move(builder).Finish();
}

}  // namespace ccst::io
