#include <cctype>
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

// A corner is `v`, `v/t`, `v//n` or `v/t/n`; v counts from 1, or back from the latest vertex.
absl::StatusOr<std::int64_t> ReadCorner(std::string_view token, std::int64_t vertices,
                                        const TextCursor& cursor) {
  const auto index = ParseInteger(token.substr(0, token.find('/')));
  if (!index.has_value()) {
    return Unreadable(
        absl::StrCat(cursor.Where(), ": ", Quoted(token), " is not a corner of a face"));
  }
  if (*index > 0) return *index - 1;
  if (*index < 0 && -*index <= vertices) return vertices + *index;
  return Degenerate(absl::StrCat(cursor.Where(), ": index ", *index, " after ", vertices,
                                 " vertices; indices count from 1, or from -1 backwards"));
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

}  // namespace

absl::StatusOr<MeshFile> ReadObj(std::string_view text, const MeshLimits& limits) {
  MeshBuilder builder(limits);
  TextCursor cursor(text, kObjSyntax);
  const auto where = [&cursor] { return cursor.Where(); };
  std::vector<std::int64_t> corners;
  for (; !cursor.AtEnd(); cursor.SkipLine()) {
    const std::string_view keyword = cursor.TokenOnLine();
    if (keyword == "v") {
      CCST_ASSIGN_OR_RETURN(const Eigen::Vector3d position, ReadVertex(cursor));
      CCST_RETURN_IF_ERROR(builder.AddVertex(position, where));
    } else if (keyword == "f") {
      corners.clear();
      for (auto token = cursor.TokenOnLine(); !token.empty(); token = cursor.TokenOnLine()) {
        CCST_ASSIGN_OR_RETURN(const std::int64_t corner,
                              ReadCorner(token, builder.vertices(), cursor));
        corners.push_back(corner);
      }
      CCST_RETURN_IF_ERROR(builder.AddFace(corners, where));
    } else if (!keyword.empty() && !std::isalpha(static_cast<unsigned char>(keyword[0]))) {
      return Unreadable(
          absl::StrCat(cursor.Where(), ": ", Quoted(keyword), " is not an OBJ statement"));
    }
  }
  return std::move(builder).Finish([text](std::int64_t face) { return FindFace(text, face); });
}

}  // namespace ccst::io
