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

// Passes the keyword. Some writers leave out the space after it, so that the first count may
// be what is left of the token.
absl::StatusOr<std::string_view> ReadKeyword(TextCursor& cursor) {
  const std::string_view token = cursor.Token();
  std::string_view rest = token;
  for (const std::string_view prefix : {"ST", "C", "N"}) {
    if (rest.starts_with(prefix)) rest.remove_prefix(prefix.size());
  }
  if (!rest.starts_with("OFF")) {
    return Unreadable(absl::StrCat(cursor.Where(),
                                   ": an OFF file starts with OFF, COFF, NOFF or STOFF, not with ",
                                   Found(token)));
  }
  return rest.substr(3);
}

}  // namespace

absl::StatusOr<MeshFile> ReadOff(std::string_view text, const MeshLimits& limits) {
  TextCursor cursor(text, {.comment = '#'});
  CCST_ASSIGN_OR_RETURN(std::string_view first_count, ReadKeyword(cursor));
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
  return std::move(builder).Finish();
}

}  // namespace ccst::io
