#include "core/io/draco_header.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "core/io/byte_reader.h"
#include "core/io/io_errors.h"

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

absl::Status Truncated(const ByteReader& reader, const char* what) {
  CCST_RETURN_IF_ERROR(reader.status());
  return NotDraco(
      absl::StrCat("byte ", reader.position(), ": the stream ends, or is damaged, in ", what));
}

void SkipName(ByteReader& reader) { reader.Skip(reader.Fixed<std::uint8_t>()); }

// Entries, then named metadata of the same shape. Every turn of these loops takes a byte, so that
// the counts cannot make them long.
void SkipMetadata(ByteReader& reader, int depth) {
  if (depth > kMaxMetadataDepth) return reader.Fail();
  const std::uint32_t entries = reader.Varint32();
  for (std::uint32_t i = 0; i < entries && !reader.failed(); ++i) {
    SkipName(reader);
    reader.Skip(reader.Varint32());
  }
  const std::uint32_t children = reader.Varint32();
  for (std::uint32_t i = 0; i < children && !reader.failed(); ++i) {
    SkipName(reader);
    SkipMetadata(reader, depth + 1);
  }
}

void SkipGeometryMetadata(ByteReader& reader) {
  const std::uint32_t attributes = reader.Varint32();
  for (std::uint32_t i = 0; i < attributes && !reader.failed(); ++i) {
    reader.Varint32();
    SkipMetadata(reader, 0);
  }
  SkipMetadata(reader, 0);
}

void ReadSequentialCounts(ByteReader& reader, bool fixed, DracoHeader& header) {
  const auto count = [&] { return fixed ? reader.Fixed<std::uint32_t>() : reader.Varint32(); };
  header.faces = count();
  header.points = count();
  header.compressed_indices = reader.Fixed<std::uint8_t>() == 0;
}

void ReadEdgebreakerCounts(ByteReader& reader, bool fixed, bool has_new_vertices,
                           DracoHeader& header) {
  const auto count = [&] { return fixed ? reader.Fixed<std::uint32_t>() : reader.Varint32(); };
  header.traversal = reader.Fixed<std::uint8_t>();
  if (has_new_vertices) count();
  header.points = count();
  header.faces = count();
  header.attribute_connectivities = reader.Fixed<std::uint8_t>();
  header.symbols = count();
  header.split_symbols = count();
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
  return ReadDracoHeader(SourceOf(bytes));
}

absl::StatusOr<DracoHeader> ReadDracoHeader(const ByteSource& source) {
  ByteReader reader(source);
  for (const char letter : kMagic) {
    if (reader.Fixed<char>() == letter && !reader.failed()) continue;
    CCST_RETURN_IF_ERROR(reader.status());
    return NotDraco("byte 0: a Draco stream starts with 'DRACO'");
  }
  DracoHeader header;
  header.version_major = reader.Fixed<std::uint8_t>();
  header.version_minor = reader.Fixed<std::uint8_t>();
  const int type = reader.Fixed<std::uint8_t>();
  const int method = reader.Fixed<std::uint8_t>();
  const auto flags = reader.Fixed<std::uint16_t>();
  if (reader.failed()) return Truncated(reader, "its header");

  const int version = header.version_major * 100 + header.version_minor;
  if (type == kPointCloud) {
    return NotDraco("the stream holds a point cloud, not a mesh; sampling a surface needs faces");
  }
  if (type != kMesh) {
    return NotDraco(absl::StrCat("byte 7: geometry type ", type, "; 1, a mesh, is expected"));
  }
  if (version < 101 || version > 202) {
    return NotDraco(absl::StrCat("byte 5: bitstream version ", header.version_major, ".",
                                 header.version_minor,
                                 "; versions 1.1 to 2.2 of meshes are known"));
  }
  if (method > 1) {
    return NotDraco(absl::StrCat("byte 8: encoding method ", method,
                                 "; 0 (sequential) and 1 (Edgebreaker) are known"));
  }
  header.method = method == 0 ? DracoMethod::kSequential : DracoMethod::kEdgebreaker;
  header.has_metadata = version >= 103 && (flags & kMetadataFlag) != 0;
  if (header.has_metadata) SkipGeometryMetadata(reader);
  if (reader.failed()) return Truncated(reader, "its metadata");
  header.counts_offset = static_cast<std::size_t>(reader.position());
  // Sequential streams took up variable-length counts two versions after Edgebreaker ones.
  if (header.method == DracoMethod::kSequential) {
    ReadSequentialCounts(reader, version < 202, header);
  } else {
    ReadEdgebreakerCounts(reader, version < 200, version < 202, header);
  }
  if (reader.failed()) return Truncated(reader, "the numbers of faces and vertices");
  header.data_offset = static_cast<std::size_t>(reader.position());
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
    return ccst::OverLimit(
        {"max_decoded_mesh_bytes", limits.max_decoded_bytes, needed},
        absl::StrCat(what, " would take about ", needed >> 20, " MiB to decode; at most ",
                     limits.max_decoded_bytes >> 20, " MiB are allowed"));
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
    return ccst::OverLimit({"max_face_count", limits.max_faces, header.faces},
                           absl::StrCat("byte ", header.counts_offset, ": announces ", header.faces,
                                        " faces; at most ", limits.max_faces, " are accepted"));
  }
  if (header.points > limits.max_vertices) {
    return ccst::OverLimit(
        {"max_vertex_count", limits.max_vertices, header.points},
        absl::StrCat("byte ", header.counts_offset, ": announces ", header.points,
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
