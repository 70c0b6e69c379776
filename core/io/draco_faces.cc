#include "core/io/draco_faces.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_header.h"
#include "core/io/draco_mesh.h"
#include "core/io/draco_names.h"
#include "core/io/io_errors.h"
#include "draco/core/decoder_buffer.h"
#include "draco/core/encoder_buffer.h"
#include "draco/core/varint_decoding.h"
#include "draco/core/varint_encoding.h"
#include "draco/metadata/geometry_metadata.h"
#include "draco/metadata/metadata_decoder.h"

namespace ccst {
namespace {

// Magic, version, type, method and flags; the metadata follows.
constexpr std::int64_t kHeaderBytes = 11;

// `count` faces in a row, each `step` after the one before and cut into `triangles`.
struct Run {
  std::uint32_t step = 0;
  std::uint32_t triangles = 0;
  std::uint32_t count = 0;
};

// The first face is counted from -1, so that a file of one kind of face is one run.
std::vector<Run> RunsOf(std::span<const std::int32_t> face_source) {
  std::vector<Run> runs;
  std::int32_t before = -1;
  for (std::size_t i = 0; i < face_source.size();) {
    std::size_t end = i + 1;
    while (end < face_source.size() && face_source[end] == face_source[i]) ++end;
    const auto step = static_cast<std::uint32_t>(face_source[i] - before);
    const auto triangles = static_cast<std::uint32_t>(end - i);
    if (runs.empty() || runs.back().step != step || runs.back().triangles != triangles) {
      runs.push_back({step, triangles, 0});
    }
    ++runs.back().count;
    before = face_source[i];
    i = end;
  }
  return runs;
}

absl::StatusOr<std::vector<std::int32_t>> Expand(const std::vector<std::uint8_t>& bytes,
                                                 std::int64_t faces) {
  const auto damaged = io::NotDraco(absl::StrCat("the metadata entry ", io::kDracoFacesEntry,
                                                 " does not number ", faces, " triangles"));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  std::vector<std::int32_t> face_source;
  std::int64_t face = -1;
  while (buffer.remaining_size() > 0) {
    Run run;
    if (!draco::DecodeVarint(&run.step, &buffer) || !draco::DecodeVarint(&run.triangles, &buffer) ||
        !draco::DecodeVarint(&run.count, &buffer)) {
      return damaged;
    }
    const std::int64_t left = faces - static_cast<std::int64_t>(face_source.size());
    const bool fits = run.triangles > 0 && run.count <= left / run.triangles &&
                      run.step <= (INT32_MAX - std::max<std::int64_t>(face, 0)) /
                                      std::max<std::int64_t>(run.count, 1);
    if (!fits) return damaged;
    for (std::uint32_t i = 0; i < run.count; ++i) {
      face += run.step;
      face_source.insert(face_source.end(), run.triangles, static_cast<std::int32_t>(face));
    }
  }
  if (face_source.empty() || static_cast<std::int64_t>(face_source.size()) != faces ||
      face_source.front() < 0) {
    return damaged;
  }
  return face_source;
}

// Triangles [first, end) of the face that triangle `first` begins.
std::size_t EndOfFace(std::span<const std::int32_t> face_source, std::size_t first) {
  std::size_t end = first + 1;
  while (end < face_source.size() && face_source[end] == face_source[first]) ++end;
  return end;
}

absl::StatusOr<std::vector<Eigen::Vector3i>> ExpandCorners(
    const std::vector<std::uint8_t>& bytes, std::span<const std::int32_t> face_source) {
  const auto damaged = io::NotDraco(absl::StrCat("the metadata entry ", io::kDracoCornersEntry,
                                                 " does not fit the mesh's faces"));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  std::vector<Eigen::Vector3i> corners(face_source.size(), Eigen::Vector3i(0, 1, 2));
  for (std::size_t first = 0, end = 0; first < face_source.size(); first = end) {
    end = EndOfFace(face_source, first);
    if (end - first == 1) continue;
    const std::size_t count = end - first + 2;
    for (std::size_t t = first; t < end; ++t) {
      for (int k = 0; k < 3; ++k) {
        std::uint32_t corner = 0;
        if (!draco::DecodeVarint(&corner, &buffer) || corner >= count) return damaged;
        corners[t][k] = static_cast<int>(corner);
      }
    }
  }
  if (buffer.remaining_size() > 0) return damaged;
  return corners;
}

// The entry of this name in the mesh's metadata; nothing where there is none.
absl::StatusOr<std::vector<std::uint8_t>> ReadEntry(const io::DracoHeader& header,
                                                    std::span<const char> bytes, const char* name) {
  std::vector<std::uint8_t> entry;
  if (!header.has_metadata) return entry;
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  buffer.Advance(kHeaderBytes);
  draco::GeometryMetadata metadata;
  if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) {
    return io::NotDraco("the metadata is damaged");
  }
  metadata.GetEntryBinary(name, &entry);
  return entry;
}

void AddEntry(const char* name, const draco::EncoderBuffer& buffer, draco::Mesh& mesh) {
  if (mesh.metadata() == nullptr) mesh.AddMetadata(std::make_unique<draco::GeometryMetadata>());
  mesh.metadata()->AddEntryBinary(
      name, std::vector<std::uint8_t>(buffer.data(), buffer.data() + buffer.size()));
}

}  // namespace

namespace io {

void AddFaceSource(std::span<const std::int32_t> face_source, draco::Mesh& mesh) {
  if (face_source.empty() || !std::is_sorted(face_source.begin(), face_source.end())) return;
  draco::EncoderBuffer buffer;
  for (const Run& run : RunsOf(face_source)) {
    draco::EncodeVarint(run.step, &buffer);
    draco::EncodeVarint(run.triangles, &buffer);
    draco::EncodeVarint(run.count, &buffer);
  }
  AddEntry(kDracoFacesEntry, buffer, mesh);
}

void AddFaceCorners(std::span<const std::int32_t> face_source,
                    std::span<const Eigen::Vector3i> face_corners, draco::Mesh& mesh) {
  if (face_corners.size() != face_source.size() || face_source.empty()) return;
  if (!std::is_sorted(face_source.begin(), face_source.end())) return;
  draco::EncoderBuffer buffer;
  for (std::size_t first = 0, end = 0; first < face_source.size(); first = end) {
    end = EndOfFace(face_source, first);
    if (end - first == 1) continue;
    for (std::size_t t = first; t < end; ++t) {
      for (const int corner : face_corners[t]) {
        draco::EncodeVarint(static_cast<std::uint32_t>(corner), &buffer);
      }
    }
  }
  if (buffer.size() > 0) AddEntry(kDracoCornersEntry, buffer, mesh);
}

}  // namespace io

absl::StatusOr<std::vector<std::int32_t>> DracoFaceSource(std::span<const char> bytes) {
  CCST_ASSIGN_OR_RETURN(const io::DracoHeader header, io::ReadDracoHeader(bytes));
  CCST_ASSIGN_OR_RETURN(const std::vector<std::uint8_t> entry,
                        ReadEntry(header, bytes, io::kDracoFacesEntry));
  if (entry.empty()) return std::vector<std::int32_t>();
  return Expand(entry, header.faces);
}

absl::StatusOr<std::vector<Eigen::Vector3i>> DracoFaceCorners(std::span<const char> bytes) {
  CCST_ASSIGN_OR_RETURN(const io::DracoHeader header, io::ReadDracoHeader(bytes));
  CCST_ASSIGN_OR_RETURN(const std::vector<std::uint8_t> entry,
                        ReadEntry(header, bytes, io::kDracoCornersEntry));
  if (entry.empty()) return std::vector<Eigen::Vector3i>();
  CCST_ASSIGN_OR_RETURN(const std::vector<std::int32_t> face_source, DracoFaceSource(bytes));
  return ExpandCorners(entry, face_source);
}

}  // namespace ccst
