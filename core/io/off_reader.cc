#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/io/off_binary_reader.h"
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

// What follows x y z on the vertices' lines: normals, then colours, then texture coordinates.
class VertexValues {
 public:
  explicit VertexValues(const Keyword& keyword) : keyword_(keyword) {}

  // Takes the rest of the line of the i-th vertex.
  void Read(std::int64_t i, TextCursor& cursor) {
    if (!keyword_.has_color && !keyword_.has_texture) return;
    std::array<double, 9> numbers = {};
    std::size_t count = 0;
    for (; count < numbers.size(); ++count) {
      const auto value = ParseDouble(cursor.TokenOnLine());
      if (!value.has_value()) break;
      numbers[count] = *value;
    }
    const std::size_t first = keyword_.has_normal ? 3 : 0;
    std::span<const double> rest = std::span(numbers).first(count);
    rest = rest.subspan(std::min(first, count));
    // Colours may have three or four numbers; what follows them tells which.
    const std::size_t behind = keyword_.has_texture ? 2 : 0;
    if (keyword_.has_color && rest.size() >= 3 + behind) {
      const std::size_t components = std::min<std::size_t>(rest.size() - behind, 4);
      AddColor(i, rest.first(components));
      rest = rest.subspan(components);
    }
    if (keyword_.has_texture && rest.size() >= 2) {
      texture_.resize(static_cast<std::size_t>(2 * i), 0.0f);
      for (const double value : rest.first(2)) texture_.push_back(static_cast<float>(value));
    }
  }

  // Adds the attributes of which there are values.
  void Finish(MeshBuilder& builder) && {
    if (!colors_.empty()) builder.AddAttribute(FinishColors(builder.vertices()));
    if (texture_.empty()) return;
    texture_.resize(static_cast<std::size_t>(2 * builder.vertices()), 0.0f);
    builder.AddAttribute({.name = "uv",
                          .kind = AttributeKind::kTextureCoordinates,
                          .components = 2,
                          .values = std::move(texture_)});
  }

 private:
  static constexpr float kNone = -1.0f;

  void AddColor(std::int64_t i, std::span<const double> color) {
    has_alpha_ = has_alpha_ || color.size() == 4;
    colors_.resize(static_cast<std::size_t>(4 * i), kNone);
    for (std::size_t k = 0; k < 4; ++k) {
      colors_.push_back(k < color.size() ? static_cast<float>(color[k]) : kNone);
      largest_ = std::max(largest_, colors_.back());
    }
  }

  Attribute FinishColors(std::int64_t vertices) {
    colors_.resize(static_cast<std::size_t>(4 * vertices), kNone);
    const int components = has_alpha_ ? 4 : 3;
    Attribute attribute{.name = "color", .kind = AttributeKind::kColor, .components = components};
    attribute.values.reserve(static_cast<std::size_t>(components * vertices));
    // Nothing says which it is; fractions end at 1.
    const float divisor = largest_ > 1.0f ? 255.0f : 1.0f;
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      if (i % 4 < static_cast<std::size_t>(components)) {
        attribute.values.push_back(colors_[i] == kNone ? 1.0f : colors_[i] / divisor);
      }
    }
    return attribute;
  }

  Keyword keyword_;
  std::vector<float> colors_;   // Four a vertex, up to the last that has one.
  std::vector<float> texture_;  // Two a vertex, up to the last that has them.
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
    cursor.SkipLine();
    return ReadBinaryOff(text.substr(cursor.position()),
                         {.has_normal = keyword.has_normal,
                          .has_color = keyword.has_color,
                          .has_texture = keyword.has_texture},
                         limits);
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
  VertexValues values(keyword);

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
    values.Read(i, cursor);
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
  std::move(values).Finish(builder);
  return std::move(builder).Finish();
}

}  // namespace ccst::io
