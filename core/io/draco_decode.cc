#include <iterator>
#include <new>
#include <stdexcept>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "core/io/draco_announced.h"
#include "core/io/draco_convert.h"
#include "core/io/draco_guard.h"
#include "core/io/draco_header.h"
#include "core/io/draco_mesh.h"
#include "core/io/io_errors.h"
#include "draco/compression/mesh/mesh_edgebreaker_decoder.h"
#include "draco/compression/mesh/mesh_sequential_decoder.h"
#include "draco/core/decoder_buffer.h"
#include "draco/mesh/mesh.h"

namespace ccst {
namespace {

// What the stream announces that decoding takes. Where that cannot be read, Draco will say why.
std::int64_t AnnouncedBytes(std::span<const char> bytes, const MeshLimits& limits) {
  const auto announced = io::ReadDracoAnnouncement(SourceOf(bytes), limits);
  return announced.ok() ? io::MemoryOf(*announced).decoder_bytes : limits.max_decoded_bytes;
}

template <typename Decoder>
absl::Status Decode(std::span<const char> bytes, const MeshLimits& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const draco::DecoderOptions options;
  io::GuardedDracoDecoder<Decoder> decoder(bytes.size(), limits, AnnouncedBytes(bytes, limits));
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  CCST_RETURN_IF_ERROR(decoder.refusal());
  if (status.ok()) return absl::OkStatus();
  const std::size_t at = bytes.size() - static_cast<std::size_t>(buffer.remaining_size());
  return io::NotDraco(absl::StrCat("near byte ", at, " of ", bytes.size(),
                                   ": the stream is damaged: ", status.error_msg_string()));
}

absl::StatusOr<TriangleMesh> DecodeChecked(std::span<const char> bytes, const MeshLimits& limits) {
  if (static_cast<std::int64_t>(bytes.size()) > limits.max_bytes) {
    return OverLimit(
        {"max_mesh_bytes", limits.max_bytes, std::ssize(bytes)},
        absl::StrCat(bytes.size(), " bytes; at most ", limits.max_bytes, " are accepted"));
  }
  CCST_ASSIGN_OR_RETURN(const io::DracoHeader header, io::ReadDracoHeader(bytes));
  CCST_RETURN_IF_ERROR(io::CheckDracoCounts(header, bytes.size(), limits));
  draco::Mesh mesh;
  if (header.method == io::DracoMethod::kSequential) {
    CCST_RETURN_IF_ERROR(Decode<draco::MeshSequentialDecoder>(bytes, limits, mesh));
  } else {
    CCST_RETURN_IF_ERROR(Decode<draco::MeshEdgebreakerDecoder>(bytes, limits, mesh));
  }
  return io::FromDraco(mesh, limits);
}

}  // namespace

absl::StatusOr<TriangleMesh> DecodeDraco(std::span<const char> bytes, const MeshLimits& limits) {
  // Draco throws nothing itself, but its containers do.
  try {
    return DecodeChecked(bytes, limits);
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                     "not enough memory to decode the mesh");
  } catch (const std::length_error&) {
    return io::NotDraco("the stream announces more than any memory holds");
  }
}

}  // namespace ccst
