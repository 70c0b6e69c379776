#include "core/io/off_binary_reader.h"

#include <bit>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_builder.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

constexpr std::size_t kWord = 4;
constexpr std::size_t kHeader = 3 * kWord;  // Vertices, faces, edges.

struct Variant {
  std::endian order = std::endian::little;
  bool has_face_colors = false;
};

struct Counts {
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
};

std::int32_t Integer(std::string_view bytes, std::size_t at, std::endian order) {
  return LoadBytes<std::int32_t>(bytes.data() + at, order);
}

// The counts, when the records of this variant take all of `bytes`. Spaces at the end do not count.
std::optional<Counts> Fit(std::string_view bytes, std::size_t vertex_bytes,
                          const Variant& variant) {
  const Counts counts = {Integer(bytes, 0, variant.order), Integer(bytes, kWord, variant.order)};
  if (counts.vertices < 0 || counts.faces < 0) return std::nullopt;
  const auto size = static_cast<std::int64_t>(bytes.size());
  std::int64_t at = static_cast<std::int64_t>(kHeader) +
                    counts.vertices * static_cast<std::int64_t>(vertex_bytes);
  // A list of words that its length precedes.
  const auto skip_list = [&] {
    if (at > size - static_cast<std::int64_t>(kWord)) return false;
    const std::int64_t length = Integer(bytes, static_cast<std::size_t>(at), variant.order);
    if (length < 0) return false;
    at += static_cast<std::int64_t>(kWord) * (1 + length);
    return at <= size;
  };
  for (std::int64_t i = 0; i < counts.faces; ++i) {
    if (!skip_list() || (variant.has_face_colors && !skip_list())) return std::nullopt;
  }
  constexpr std::int64_t kSlack = 2;
  return at <= size && at >= size - kSlack ? std::optional(counts) : std::nullopt;
}

class Reader {
 public:
  Reader(std::string_view bytes, const Variant& variant, const MeshLimits& limits)
      : bytes_(bytes), variant_(variant), builder_(limits) {}

  absl::StatusOr<MeshFile> Read(const Counts& counts, const OffVertexValues& values,
                                std::size_t vertex_bytes) {
    CCST_RETURN_IF_ERROR(builder_.Announce(counts.vertices, counts.faces,
                                           static_cast<std::int64_t>(bytes_.size()),
                                           static_cast<std::int64_t>(vertex_bytes), kWord));
    const auto where = [this] { return absl::StrCat("byte ", at_, " of the records"); };
    std::vector<float> colors;
    std::vector<float> texture;
    for (std::int64_t i = 0; i < counts.vertices; ++i) {
      Eigen::Vector3d position;
      for (double& coordinate : position) coordinate = Float();
      CCST_RETURN_IF_ERROR(builder_.AddVertex(position, where));
      if (values.has_normal) at_ += 3 * kWord;
      for (int k = 0; values.has_color && k < 4; ++k) colors.push_back(Float());
      for (int k = 0; values.has_texture && k < 2; ++k) texture.push_back(Float());
    }
    builder_.SetVertexCount(counts.vertices);
    std::vector<std::int64_t> corners;
    for (std::int64_t i = 0; i < counts.faces; ++i) {
      corners.resize(static_cast<std::size_t>(Word()));
      for (std::int64_t& corner : corners) corner = Word();
      CCST_RETURN_IF_ERROR(builder_.AddFace(corners, where));
      if (variant_.has_face_colors) at_ += kWord * static_cast<std::size_t>(Word());
    }
    Add("color", AttributeKind::kColor, 4, std::move(colors));
    Add("uv", AttributeKind::kTextureCoordinates, 2, std::move(texture));
    return std::move(builder_).Finish();
  }

 private:
  std::int32_t Word() {
    const std::int32_t value = Integer(bytes_, at_, variant_.order);
    at_ += kWord;
    return value;
  }

  float Float() {
    const auto value = LoadBytes<float>(bytes_.data() + at_, variant_.order);
    at_ += kWord;
    return value;
  }

  void Add(const char* name, AttributeKind kind, int components, std::vector<float> values) {
    if (values.empty()) return;
    builder_.AddAttribute(
        {.name = name, .kind = kind, .components = components, .values = std::move(values)});
  }

  std::string_view bytes_;
  Variant variant_;
  MeshBuilder builder_;
  std::size_t at_ = kHeader;
};

}  // namespace

absl::StatusOr<MeshFile> ReadBinaryOff(std::string_view bytes, const OffVertexValues& values,
                                       const MeshLimits& limits) {
  if (bytes.size() < kHeader) return Unreadable("the binary OFF file ends before its counts");
  const std::size_t vertex_bytes =
      kWord * (3 + (values.has_normal ? 3U : 0U) + (values.has_color ? 4U : 0U) +
               (values.has_texture ? 2U : 0U));
  for (const std::endian order : {std::endian::big, std::endian::little}) {
    for (const bool has_face_colors : {true, false}) {
      const Variant variant = {.order = order, .has_face_colors = has_face_colors};
      const auto counts = Fit(bytes, vertex_bytes, variant);
      if (counts.has_value())
        return Reader(bytes, variant, limits).Read(*counts, values, vertex_bytes);
    }
  }
  return Unreadable(absl::StrCat("the ", bytes.size(), " bytes behind the keyword are not the ",
                                 "records of a binary OFF file; save it as text or as PLY"));
}

}  // namespace ccst::io
