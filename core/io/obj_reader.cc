#include <algorithm>
#include <array>
#include <cctype>
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

constexpr TextCursor::Syntax kObjSyntax = {.comment = '#', .continuation = true};

// Numbers at the start of what is left of the line, up to N of them.
template <int N>
int ReadNumbers(TextCursor& cursor, std::array<double, N>& numbers) {
  int count = 0;
  for (; count < N; ++count) {
    const auto value = ParseDouble(cursor.TokenOnLine());
    if (!value.has_value()) break;
    numbers[count] = *value;
  }
  return count;
}

absl::StatusOr<Eigen::Vector3d> ReadVertex(TextCursor& cursor) {
  Eigen::Vector3d position;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view token = cursor.TokenOnLine();
    const auto value = ParseDouble(token);
    if (!value.has_value()) {
      return Unreadable(absl::StrCat(cursor.Where(), ": 'v' needs three numbers, found ",
                                     token.empty() ? "the line's end" : Quoted(token)));
    }
    position[axis] = *value;
  }
  return position;
}

// An index that counts from 1, or back from the latest of `count` things, counted from 0.
absl::StatusOr<std::int64_t> ToIndex(std::string_view token, std::int64_t count, const char* what,
                                     const TextCursor& cursor) {
  const auto index = ParseInteger(token);
  if (!index.has_value()) {
    return Unreadable(
        absl::StrCat(cursor.Where(), ": ", Quoted(token), " is not a corner of a face"));
  }
  if (*index > 0) return *index - 1;
  if (*index < 0 && -*index <= count) return count + *index;
  return Degenerate(absl::StrCat(cursor.Where(), ": index ", *index, " after ", count, " ", what,
                                 "; indices count from 1, or from -1 backwards"));
}

// Where the i-th face is: looked for only when it turned out to be wrong.
std::string FindFace(std::string_view text, std::int64_t face) {
  TextCursor cursor(text, kObjSyntax);
  std::int64_t seen = 0;
  while (!cursor.AtEnd()) {
    if (cursor.TokenOnLine() == "f" && seen++ == face) break;
    cursor.SkipLine();
  }
  return cursor.Where();
}

class ObjReader {
 public:
  ObjReader(std::string_view text, const MeshLimits& limits)
      : text_(text), cursor_(text, kObjSyntax), builder_(limits) {}

  absl::StatusOr<MeshFile> Read() {
    for (; !cursor_.AtEnd(); cursor_.SkipLine()) {
      const std::string_view keyword = cursor_.TokenOnLine();
      if (keyword == "v") {
        CCST_RETURN_IF_ERROR(AddVertex());
      } else if (keyword == "vt") {
        std::array<double, 2> uv = {};
        ReadNumbers<2>(cursor_, uv);
        texture_.emplace_back(static_cast<float>(uv[0]), static_cast<float>(uv[1]));
      } else if (keyword == "f") {
        CCST_RETURN_IF_ERROR(AddFace());
      } else if (!keyword.empty() && !std::isalpha(static_cast<unsigned char>(keyword[0]))) {
        return Unreadable(
            absl::StrCat(cursor_.Where(), ": ", Quoted(keyword), " is not an OBJ statement"));
      }
    }
    if (!colors_.empty()) {
      // Nothing says whether they are fractions or bytes; fractions end at 1.
      const float divisor =
          *std::max_element(colors_.begin(), colors_.end()) > 1.0f ? 255.0f : 1.0f;
      for (float& value : colors_) value /= divisor;
      for (const std::int64_t vertex : colorless_) {
        std::fill_n(colors_.begin() + 3 * vertex, 3, 1.0f);
      }
      colors_.resize(static_cast<std::size_t>(3 * builder_.vertices()), 1.0f);
      builder_.AddAttribute({.name = "color",
                             .kind = AttributeKind::kColor,
                             .components = 3,
                             .values = std::move(colors_)});
    }
    CCST_RETURN_IF_ERROR(AddTexture());
    return std::move(builder_).Finish([this](std::int64_t face) { return FindFace(text_, face); });
  }

 private:
  absl::Status AddVertex() {
    CCST_ASSIGN_OR_RETURN(const Eigen::Vector3d position, ReadVertex(cursor_));
    // A fourth number alone is the weight of a rational curve; three are a colour.
    std::array<double, 3> color = {};
    if (ReadNumbers<3>(cursor_, color) == 3) {
      for (auto v = static_cast<std::int64_t>(colors_.size() / 3); v < builder_.vertices(); ++v) {
        colorless_.push_back(v);
      }
      colors_.resize(static_cast<std::size_t>(3 * builder_.vertices()), 0.0f);
      for (const double value : color) colors_.push_back(static_cast<float>(value));
    }
    return builder_.AddVertex(position, [this] { return cursor_.Where(); });
  }

  // A corner is `v`, `v/t`, `v//n` or `v/t/n`.
  absl::Status AddFace() {
    corners_.clear();
    polygon_texture_.clear();
    bool has_texture = false;
    const auto texture_count = static_cast<std::int64_t>(texture_.size());
    for (auto token = cursor_.TokenOnLine(); !token.empty(); token = cursor_.TokenOnLine()) {
      const std::size_t slash = std::min(token.find('/'), token.size());
      CCST_ASSIGN_OR_RETURN(
          const std::int64_t corner,
          ToIndex(token.substr(0, slash), builder_.vertices(), "vertices", cursor_));
      corners_.push_back(corner);
      const std::string_view rest = token.substr(std::min(slash + 1, token.size()));
      const std::string_view texture = rest.substr(0, rest.find('/'));
      std::int64_t index = -1;
      if (!texture.empty()) {
        CCST_ASSIGN_OR_RETURN(index,
                              ToIndex(texture, texture_count, "texture coordinates", cursor_));
      }
      has_texture = has_texture || index >= 0;
      polygon_texture_.push_back(index);
    }
    if (has_texture || !corner_texture_.empty()) {
      corner_texture_.resize(builder_.corners(), -1);
      AppendFan<std::int64_t>(polygon_texture_, corner_texture_);
    }
    return builder_.AddFace(corners_, [this] { return cursor_.Where(); });
  }

  // Indices without any texture coordinates mean nothing; corners without an index get (0, 0).
  absl::Status AddTexture() {
    if (texture_.empty() || corner_texture_.empty()) return absl::OkStatus();
    std::vector<Eigen::Vector2f> uv(corner_texture_.size(), Eigen::Vector2f::Zero());
    for (std::size_t i = 0; i < uv.size(); ++i) {
      const std::int64_t index = corner_texture_[i];
      if (index < 0) continue;
      if (index >= static_cast<std::int64_t>(texture_.size())) {
        return Degenerate(absl::StrCat("a corner of triangle ", i / 3, " is at texture coordinate ",
                                       index, ", but there are ", texture_.size(),
                                       " (both counted from 0)"));
      }
      uv[i] = texture_[static_cast<std::size_t>(index)];
    }
    builder_.AddCornerTexture(uv);
    return absl::OkStatus();
  }

  std::string_view text_;
  TextCursor cursor_;
  MeshBuilder builder_;
  std::vector<float> colors_;                 // Three a vertex, up to the last that has them.
  std::vector<std::int64_t> colorless_;       // Vertices before the last with a colour.
  std::vector<Eigen::Vector2f> texture_;      // As the file lists them.
  std::vector<std::int64_t> corner_texture_;  // Three a triangle, into texture_; -1 for none.
  std::vector<std::int64_t> corners_;         // Of the face being read.
  std::vector<std::int64_t> polygon_texture_;
};

}  // namespace

absl::StatusOr<MeshFile> ReadObj(std::string_view text, const MeshLimits& limits) {
  return ObjReader(text, limits).Read();
}

}  // namespace ccst::io
