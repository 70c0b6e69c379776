#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/mesh_readers.h"
#include "core/io/numbers.h"
#include "core/io/text_cursor.h"

namespace ccst::io {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kPreambleBytes = kHeaderBytes + 4;
constexpr std::size_t kFacetBytes = 50;

bool EqualsIgnoringCase(std::string_view token, std::string_view lowercase) {
  return std::equal(
      token.begin(), token.end(), lowercase.begin(), lowercase.end(),
      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

// Gives equal positions one vertex. Negative zero counts as zero: exporters mix the two, which
// would tear the surface.
class VertexMerger {
 public:
  explicit VertexMerger(MeshBuilder& builder) : builder_(builder) {}

  template <typename WhereFunction>
  absl::StatusOr<std::int64_t> Add(const Eigen::Vector3d& given, const WhereFunction& where) {
    const Eigen::Vector3d position = given.array() + 0.0;
    std::array<std::uint64_t, 3> key;
    std::memcpy(key.data(), position.data(), sizeof(key));
    const auto [entry, is_new] =
        vertices_.try_emplace(key, static_cast<std::int32_t>(builder_.vertices()));
    if (is_new) CCST_RETURN_IF_ERROR(builder_.AddVertex(position, where));
    return entry->second;
  }

 private:
  MeshBuilder& builder_;
  absl::flat_hash_map<std::array<std::uint64_t, 3>, std::int32_t> vertices_;
};

absl::StatusOr<MeshFile> ReadBinary(std::string_view bytes, const MeshLimits& limits) {
  std::size_t facets = LoadBytes<std::uint32_t>(bytes.data() + kHeaderBytes, std::endian::little);
  const std::size_t body = bytes.size() - kPreambleBytes;
  const std::size_t room = body / kFacetBytes;
  // Programs that write while they go, and never come back to fill in the count, leave 0.
  if (facets == 0 && body % kFacetBytes == 0) facets = room;
  if (facets > room) {
    return Unreadable(absl::StrCat("byte ", kHeaderBytes, ": announces ", facets,
                                   " facets, but the file ends after ", room));
  }
  MeshBuilder builder(limits);
  CCST_RETURN_IF_ERROR(builder.Announce(0, static_cast<std::int64_t>(facets),
                                        static_cast<std::int64_t>(bytes.size()), 1, kFacetBytes));
  VertexMerger merger(builder);
  std::array<std::int64_t, 3> corners;
  for (std::size_t i = 0; i < facets; ++i) {
    const std::size_t facet = kPreambleBytes + i * kFacetBytes;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t offset = facet + 12 * (k + 1);  // The normal comes first.
      const auto where = [offset] { return absl::StrCat("byte ", offset); };
      Eigen::Vector3d position;
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] = LoadBytes<float>(bytes.data() + offset + 4 * axis, std::endian::little);
      }
      CCST_ASSIGN_OR_RETURN(corners[k], merger.Add(position, where));
    }
    CCST_RETURN_IF_ERROR(
        builder.AddFace(corners, [facet] { return absl::StrCat("byte ", facet); }));
  }
  return std::move(builder).Finish();
}

absl::Status Expect(TextCursor& cursor, std::string_view keyword) {
  const std::string_view token = cursor.Token();
  if (EqualsIgnoringCase(token, keyword)) return absl::OkStatus();
  return Unreadable(absl::StrCat(cursor.Where(), ": expected '", std::string(keyword), "', found ",
                                 token.empty() ? "the end of the file" : Quoted(token)));
}

absl::StatusOr<Eigen::Vector3d> ReadPosition(TextCursor& cursor) {
  Eigen::Vector3d position;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view token = cursor.Token();
    const auto value = ParseDouble(token);
    if (!value.has_value()) {
      return Unreadable(absl::StrCat(cursor.Where(), ": expected a coordinate, found ",
                                     token.empty() ? "the end of the file" : Quoted(token)));
    }
    position[axis] = *value;
  }
  return position;
}

absl::StatusOr<MeshFile> ReadText(std::string_view text, const MeshLimits& limits) {
  MeshBuilder builder(limits);
  VertexMerger merger(builder);
  TextCursor cursor(text, {});
  const auto where = [&cursor] { return cursor.Where(); };
  for (std::string_view token = cursor.Token(); !token.empty(); token = cursor.Token()) {
    if (EqualsIgnoringCase(token, "solid") || EqualsIgnoringCase(token, "endsolid")) {
      cursor.SkipLine();  // A name, of any words.
      continue;
    }
    if (!EqualsIgnoringCase(token, "facet")) {
      return Unreadable(
          absl::StrCat(cursor.Where(), ": expected 'facet' or 'endsolid', found ", Quoted(token)));
    }
    // The normal may be anything, `nan` included: faces say where they look.
    CCST_RETURN_IF_ERROR(Expect(cursor, "normal"));
    for (int axis = 0; axis < 3; ++axis) cursor.Token();
    CCST_RETURN_IF_ERROR(Expect(cursor, "outer"));
    CCST_RETURN_IF_ERROR(Expect(cursor, "loop"));
    std::array<std::int64_t, 3> corners;
    for (std::int64_t& corner : corners) {
      CCST_RETURN_IF_ERROR(Expect(cursor, "vertex"));
      CCST_ASSIGN_OR_RETURN(const Eigen::Vector3d position, ReadPosition(cursor));
      CCST_ASSIGN_OR_RETURN(corner, merger.Add(position, where));
    }
    CCST_RETURN_IF_ERROR(Expect(cursor, "endloop"));
    CCST_RETURN_IF_ERROR(Expect(cursor, "endfacet"));
    CCST_RETURN_IF_ERROR(builder.AddFace(corners, where));
  }
  // A missing `endsolid` takes no facet away: one that is cut off was refused above.
  return std::move(builder).Finish();
}

}  // namespace

absl::StatusOr<MeshFile> ReadStl(std::string_view bytes, const MeshLimits& limits) {
  const bool has_count = bytes.size() >= kPreambleBytes;
  // Many binary files begin with "solid" too: the size decides.
  if (has_count) {
    const auto facets = LoadBytes<std::uint32_t>(bytes.data() + kHeaderBytes, std::endian::little);
    if (bytes.size() == kPreambleBytes + kFacetBytes * std::size_t{facets}) {
      return ReadBinary(bytes, limits);
    }
  }
  TextCursor cursor(bytes, {});
  const bool has_zeros = bytes.find('\0') != std::string_view::npos;
  if (EqualsIgnoringCase(cursor.Token(), "solid") && !has_zeros) return ReadText(bytes, limits);
  if (has_count) return ReadBinary(bytes, limits);
  return Unreadable(absl::StrCat("neither text that starts with 'solid' nor the ", kPreambleBytes,
                                 " bytes a binary STL file starts with; the file has ",
                                 bytes.size(), " bytes"));
}

}  // namespace ccst::io
