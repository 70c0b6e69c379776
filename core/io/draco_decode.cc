#include <new>
#include <stdexcept>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
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

template <typename Decoder>
absl::Status Decode(std::span<const char> bytes, const MeshLimits& limits, draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const draco::DecoderOptions options;
  io::GuardedDracoDecoder<Decoder> decoder(bytes.size(), limits);
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  CCST_RETURN_IF_ERROR(decoder.refusal());
  if (status.ok()) return absl::OkStatus();
  const std::size_t at = bytes.size() - static_cast<std::size_t>(buffer.remaining_size());
  return io::NotDraco(absl::StrCat("near byte ", at, " of ", bytes.size(),
                                   ": the stream is damaged: ", status.error_msg_string()));
}

absl::StatusOr<TriangleMesh> Convert(const draco::Mesh& mesh, const MeshLimits& limits) {
  const draco::PointAttribute* const positions =
      mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (positions == nullptr) return io::NotDraco("the mesh has no position attribute");
  if (positions->num_components() != 3) {
    return io::NotDraco(absl::StrCat("positions have ", int{positions->num_components()},
                                     " components instead of 3"));
  }
  if (mesh.num_faces() == 0) return io::Empty("the mesh has no faces");
  const auto vertices = static_cast<std::int64_t>(positions->size());
  if (vertices > limits.max_vertices) {
    return io::OverLimit(absl::StrCat("the mesh has ", vertices, " vertices; at most ",
                                      limits.max_vertices, " are accepted"));
  }
  TriangleMesh result;
  result.positions.resize(static_cast<std::size_t>(vertices));
  for (std::int64_t i = 0; i < vertices; ++i) {
    Eigen::Vector3d& position = result.positions[static_cast<std::size_t>(i)];
    const draco::AttributeValueIndex value(static_cast<std::uint32_t>(i));
    if (!positions->ConvertValue<double, 3>(value, position.data())) {
      return io::NotDraco(absl::StrCat("position ", i, " is of a type that is no number"));
    }
    if (!position.allFinite()) {
      return io::Degenerate(
          absl::StrCat("vertex ", i, " (counted from 0) has a coordinate that is ", "not finite"));
    }
  }
  result.faces.resize(mesh.num_faces());
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (int corner = 0; corner < 3; ++corner) {
      const draco::PointIndex point = mesh.face(face)[corner];
      const std::int64_t vertex =
          point < mesh.num_points() ? std::int64_t{positions->mapped_index(point).value()} : -1;
      if (vertex < 0 || vertex >= vertices) {
        return io::Degenerate(absl::StrCat("face ", face.value(), " (counted from 0) has a corner ",
                                           "outside the ", vertices, " vertices"));
      }
      result.faces[face.value()][corner] = static_cast<int>(vertex);
    }
  }
  return result;
}

absl::StatusOr<TriangleMesh> DecodeChecked(std::span<const char> bytes, const MeshLimits& limits) {
  if (static_cast<std::int64_t>(bytes.size()) > limits.max_bytes) {
    return io::OverLimit(
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
  return Convert(mesh, limits);
}

}  // namespace

absl::StatusOr<TriangleMesh> DecodeDraco(std::span<const char> bytes, const MeshLimits& limits) {
  // Draco throws nothing itself, but its containers do.
  try {
    return DecodeChecked(bytes, limits);
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kLimitExceeded,
                     "not enough memory to decode the mesh");
  } catch (const std::length_error&) {
    return io::NotDraco("the stream announces more than any memory holds");
  }
}

}  // namespace ccst
