#include "core/io/draco_header.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

constexpr std::string_view kMagic = "DRACO";
constexpr std::uint16_t kMetadataFlag = 0x8000;
constexpr int kPointCloud = 0;
constexpr int kMesh = 1;
// The decoder's own limit, and our guard against deep nesting.
constexpr int kMaxMetadataDepth = 1000;

// Bytes the decoder allocates a face: corner table (24), the mesh's faces (12), traversal
// lists (8), visited flags and queues; a vertex: corner table, flags, maps, coordinates; and a
// face for each attribute with seams of its own: corner to vertex, edge flags.
constexpr std::int64_t kBytesPerFace = 64;
constexpr std::int64_t kBytesPerVertex = 64;
constexpr std::int64_t kBytesPerSeamFace = 40;

class Reader {
 public:
  explicit Reader(std::span<const char> bytes) : bytes_(bytes) {}

  template <typename T>
  std::optional<T> Fixed() {
    if (remaining() < sizeof(T)) return std::nullopt;
    const T value = LoadBytes<T>(bytes_.data() + position_, std::endian::little);
    position_ += sizeof(T);
    return value;
  }

  // LEB128, at most as many bytes as 32 bits take.
  std::optional<std::uint32_t> Varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const auto byte = Fixed<std::uint8_t>();
      if (!byte.has_value()) return std::nullopt;
      value |= std::uint64_t{*byte & 0x7fu} << shift;
      if ((*byte & 0x80u) == 0) {
        if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
        return static_cast<std::uint32_t>(value);
      }
    }
    return std::nullopt;
  }

  bool Skip(std::size_t count) {
    if (count > remaining()) return false;
    position_ += count;
    return true;
  }

  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

 private:
  std::span<const char> bytes_;
  std::size_t position_ = 0;
};

absl::Status Truncated(const Reader& reader, const char* what) {
  return NotDraco(
      absl::StrCat("byte ", reader.position(), ": the stream ends, or is damaged, in ", what));
}

bool SkipName(Reader& reader) {
  const auto size = reader.Fixed<std::uint8_t>();
  return size.has_value() && reader.Skip(*size);
}

// Entries, then named metadata of the same shape.
bool SkipMetadata(Reader& reader, int depth) {
  if (depth > kMaxMetadataDepth) return false;
  const auto entries = reader.Varint();
  if (!entries.has_value()) return false;
  for (std::uint32_t i = 0; i < *entries; ++i) {
    if (!SkipName(reader)) return false;
    const auto size = reader.Varint();
    if (!size.has_value() || !reader.Skip(*size)) return false;
  }
  const auto children = reader.Varint();
  if (!children.has_value()) return false;
  for (std::uint32_t i = 0; i < *children; ++i) {
    if (!SkipName(reader) || !SkipMetadata(reader, depth + 1)) return false;
  }
  return true;
}

// Every turn of these loops takes a byte, so that the counts cannot make them long.
bool SkipGeometryMetadata(Reader& reader) {
  const auto attributes = reader.Varint();
  if (!attributes.has_value()) return false;
  for (std::uint32_t i = 0; i < *attributes; ++i) {
    if (!reader.Varint().has_value() || !SkipMetadata(reader, 0)) return false;
  }
  return SkipMetadata(reader, 0);
}

bool ReadSequentialCounts(Reader& reader, bool fixed, DracoHeader& header) {
  const auto faces = fixed ? reader.Fixed<std::uint32_t>() : reader.Varint();
  const auto points = fixed ? reader.Fixed<std::uint32_t>() : reader.Varint();
  const auto method = reader.Fixed<std::uint8_t>();
  if (!faces.has_value() || !points.has_value() || !method.has_value()) return false;
  header.faces = *faces;
  header.points = *points;
  header.compressed_indices = *method == 0;
  return true;
}

bool ReadEdgebreakerCounts(Reader& reader, bool fixed, bool has_new_vertices, DracoHeader& header) {
  const auto count = [&] { return fixed ? reader.Fixed<std::uint32_t>() : reader.Varint(); };
  const auto traversal = reader.Fixed<std::uint8_t>();
  if (!traversal.has_value()) return false;
  if (has_new_vertices && !count().has_value()) return false;
  const auto vertices = count();
  const auto faces = count();
  const auto attributes = reader.Fixed<std::uint8_t>();
  const auto symbols = count();
  const auto splits = count();
  if (!vertices.has_value() || !faces.has_value() || !attributes.has_value() ||
      !symbols.has_value() || !splits.has_value()) {
    return false;
  }
  header.traversal = *traversal;
  header.points = *vertices;
  header.faces = *faces;
  header.attribute_connectivities = *attributes;
  header.symbols = *symbols;
  header.split_symbols = *splits;
  return true;
}

// Bytes of a vertex index in a sequential stream without entropy coding.
std::int64_t RawIndexBytes(const DracoHeader& header) {
  if (header.points < 256) return 1;
  if (header.points < 65536) return 2;
  const bool varint =
      header.version_major > 2 || (header.version_major == 2 && header.version_minor >= 2);
  return varint && header.points < (1 << 21) ? 1 : 4;
}

absl::Status Impossible(const DracoHeader& header, const std::string& why) {
  return NotDraco(absl::StrCat("byte ", header.counts_offset, ": announces ", header.faces,
                               " faces and ", header.points, " vertices, ", why));
}

}  // namespace

absl::StatusOr<DracoHeader> ReadDracoHeader(std::span<const char> bytes) {
  if (!std::string_view(bytes.data(), bytes.size()).starts_with(kMagic)) {
    return NotDraco("byte 0: a Draco stream starts with 'DRACO'");
  }
  Reader reader(bytes);
  reader.Skip(kMagic.size());
  const auto major = reader.Fixed<std::uint8_t>();
  const auto minor = reader.Fixed<std::uint8_t>();
  const auto type = reader.Fixed<std::uint8_t>();
  const auto method = reader.Fixed<std::uint8_t>();
  const auto flags = reader.Fixed<std::uint16_t>();
  if (!flags.has_value()) return Truncated(reader, "its header");

  DracoHeader header;
  header.version_major = *major;
  header.version_minor = *minor;
  const int version = *major * 100 + *minor;
  if (*type == kPointCloud) {
    return NotDraco("the stream holds a point cloud, not a mesh; sampling a surface needs faces");
  }
  if (*type != kMesh) {
    return NotDraco(absl::StrCat("byte 7: geometry type ", *type, "; 1, a mesh, is expected"));
  }
  if (version < 101 || version > 202) {
    return NotDraco(absl::StrCat("byte 5: bitstream version ", *major, ".", *minor,
                                 "; versions 1.1 to 2.2 of meshes are known"));
  }
  if (*method > 1) {
    return NotDraco(absl::StrCat("byte 8: encoding method ", *method,
                                 "; 0 (sequential) and 1 (Edgebreaker) are known"));
  }
  header.method = *method == 0 ? DracoMethod::kSequential : DracoMethod::kEdgebreaker;
  header.has_metadata = version >= 103 && (*flags & kMetadataFlag) != 0;
  if (header.has_metadata && !SkipGeometryMetadata(reader)) {
    return Truncated(reader, "its metadata");
  }
  header.counts_offset = reader.position();
  // Sequential streams took up variable-length counts two versions after Edgebreaker ones.
  const bool read = header.method == DracoMethod::kSequential
                        ? ReadSequentialCounts(reader, version < 202, header)
                        : ReadEdgebreakerCounts(reader, version < 200, version < 202, header);
  if (!read) return Truncated(reader, "the numbers of faces and vertices");
  header.data_offset = reader.position();
  return header;
}

std::int64_t DracoMemoryBudget(std::size_t size, const MeshLimits& limits) {
  constexpr std::int64_t kFloor = std::int64_t{32} << 20;
  constexpr std::int64_t kPerByte = 16384;
  const auto bytes = static_cast<std::int64_t>(std::min<std::size_t>(size, std::size_t{1} << 40));
  return std::min(limits.max_decoded_bytes, kFloor + kPerByte * bytes);
}

absl::Status CheckDracoMemory(std::int64_t needed, std::size_t size, const MeshLimits& limits,
                              const std::string& what) {
  if (needed > limits.max_decoded_bytes) {
    return OverLimit(absl::StrCat(what, " would take about ", needed >> 20,
                                  " MiB to decode; at most ", limits.max_decoded_bytes >> 20,
                                  " MiB are allowed"));
  }
  if (needed > DracoMemoryBudget(size, limits)) {
    return NotDraco(
        absl::StrCat(what, ", which a stream of ", size, " bytes does not plausibly hold"));
  }
  return absl::OkStatus();
}

absl::Status CheckDracoCounts(const DracoHeader& header, std::size_t size,
                              const MeshLimits& limits) {
  if (header.faces == 0) {
    return Empty(absl::StrCat("the mesh has no faces (and ", header.points, " vertices)"));
  }
  if (header.faces > limits.max_faces) {
    return OverLimit(absl::StrCat("byte ", header.counts_offset, ": announces ", header.faces,
                                  " faces; at most ", limits.max_faces, " are accepted"));
  }
  if (header.points > limits.max_vertices) {
    return OverLimit(absl::StrCat("byte ", header.counts_offset, ": announces ", header.points,
                                  " vertices; at most ", limits.max_vertices, " are accepted"));
  }
  if (header.points > 3 * header.faces) return Impossible(header, "more than there are corners");
  const auto left = static_cast<std::int64_t>(size - header.data_offset);
  std::int64_t needed = header.faces * kBytesPerFace + header.points * kBytesPerVertex;
  if (header.method == DracoMethod::kSequential) {
    const std::int64_t per_face = header.compressed_indices ? 3 : 3 * RawIndexBytes(header);
    // The decoder counts the byte that says whether indices are compressed.
    const std::int64_t slack = header.compressed_indices ? 1 : 0;
    if (header.faces > (left + slack) / per_face) {
      return Impossible(header, absl::StrCat("but at ", per_face, " bytes a face the ", left,
                                             " bytes left hold at most ", left / per_face));
    }
  } else {
    if (header.symbols > header.faces || header.faces > header.symbols + header.symbols / 3 ||
        header.split_symbols > header.symbols) {
      return Impossible(
          header, absl::StrCat("which contradicts its ", header.symbols, " traversal symbols, ",
                               header.split_symbols, " of them splits"));
    }
    if (header.traversal == 0 && header.symbols > 8 * left) {
      return Impossible(header, absl::StrCat("but at a bit a symbol the ", left,
                                             " bytes left hold at most ", 8 * left));
    }
    needed += header.split_symbols * kBytesPerVertex +
              header.attribute_connectivities * header.faces * kBytesPerSeamFace;
  }
  return CheckDracoMemory(needed, size, limits,
                          absl::StrCat("byte ", header.counts_offset, ": announces ", header.faces,
                                       " faces and ", header.points, " vertices"));
}

}  // namespace ccst::io
