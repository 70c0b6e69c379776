#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_attributes.h"
#include "core/io/draco_faces.h"
#include "core/io/draco_header.h"
#include "core/io/draco_mesh.h"
#include "core/io/draco_names.h"
#include "core/io/draco_points.h"
#include "core/io/io_errors.h"
#include "core/mesh/attributes.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/mesh/mesh.h"

namespace ccst {
namespace {

// As many as a float holds; beyond, the encoder takes seconds and gigabytes for nothing.
constexpr int kMaxQuantizationBits = 24;
// Bytes a face that decoders want to see behind a sequential header, compressed or not.
constexpr std::int64_t kDecoderBytesPerFace = 3;

absl::Status Validate(const TriangleMesh& mesh, std::optional<int> quantization_bits) {
  if (quantization_bits.has_value() &&
      (*quantization_bits < 1 || *quantization_bits > kMaxQuantizationBits)) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                     absl::StrCat("quantization bits are ", *quantization_bits,
                                  "; they must be in [1, ", kMaxQuantizationBits, "]"));
  }
  if (mesh.faces.empty()) return io::Empty("the mesh has no faces; Draco needs one");
  constexpr std::size_t kMaxCount = std::numeric_limits<std::int32_t>::max() / 3;
  if (mesh.positions.size() > kMaxCount || mesh.faces.size() > kMaxCount) {
    return io::OverLimit(absl::StrCat(mesh.positions.size(), " vertices, ", mesh.faces.size(),
                                      " faces; Draco counts to ", kMaxCount));
  }
  const auto vertices = static_cast<std::int64_t>(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    if (mesh.faces[i].minCoeff() >= 0 && mesh.faces[i].maxCoeff() < vertices) continue;
    return io::Degenerate(absl::StrCat("face ", i, " (counted from 0) has a corner outside the ",
                                       vertices, " vertices"));
  }
  return CheckAttributes(mesh);
}

using Type = draco::GeometryAttribute::Type;

void AddAttribute(const Attribute& attribute, const io::DracoPoints& points, draco::Mesh& mesh) {
  draco::PointAttribute* const out = io::AddDracoAttribute(mesh, attribute);
  const auto width = static_cast<std::size_t>(attribute.components);
  constexpr std::array<float, 4> kNone = {};
  for (std::uint32_t p = 0; p < points.count(); ++p) {
    const std::int64_t row = attribute.per_corner ? points.corner[p] : points.vertex[p];
    const float* const value =
        row < 0 ? kNone.data() : attribute.values.data() + width * static_cast<std::size_t>(row);
    out->SetAttributeValue(draco::AttributeValueIndex(p), value);
  }
}

// Which points are the same vertex as the one before.
void AddSplits(const io::DracoPoints& points, draco::Mesh& mesh) {
  draco::PointAttribute* const out =
      io::AddDracoAttribute(mesh, Type::GENERIC, draco::DT_UINT8, 1, io::kDracoSplitsName);
  for (std::uint32_t p = 0; p < points.count(); ++p) {
    const std::uint8_t is_same = p > 0 && points.vertex[p] == points.vertex[p - 1] ? 1 : 0;
    out->SetAttributeValue(draco::AttributeValueIndex(p), &is_same);
  }
}

absl::StatusOr<std::unique_ptr<draco::Mesh>> ToDraco(const TriangleMesh& mesh) {
  const io::DracoPoints points = io::SplitIntoPoints(mesh);
  auto result = std::make_unique<draco::Mesh>();
  result->set_num_points(static_cast<std::uint32_t>(points.count()));
  draco::PointAttribute* const positions =
      io::AddDracoAttribute(*result, Type::POSITION, draco::DT_FLOAT32, 3, "");
  for (std::uint32_t p = 0; p < points.count(); ++p) {
    const auto vertex = static_cast<std::size_t>(points.vertex[p]);
    const Eigen::Vector3f position = mesh.positions[vertex].cast<float>();
    if (!position.allFinite()) {
      return io::Degenerate(absl::StrCat("vertex ", vertex,
                                         " (counted from 0) has a coordinate that is ",
                                         "no finite 32-bit float; scale the mesh down"));
    }
    positions->SetAttributeValue(draco::AttributeValueIndex(p), position.data());
  }
  for (const Attribute& attribute : mesh.attributes) AddAttribute(attribute, points, *result);
  if (points.count() > mesh.positions.size()) AddSplits(points, *result);
  result->SetNumFaces(mesh.faces.size());
  for (std::uint32_t i = 0; i < mesh.faces.size(); ++i) {
    draco::Mesh::Face face;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      face[static_cast<int>(corner)] = points.of_corner[3 * std::size_t{i} + corner];
    }
    result->SetFace(draco::FaceIndex(i), face);
  }
  return result;
}

absl::StatusOr<std::string> Encode(const draco::Mesh& mesh, std::optional<int> quantization_bits,
                                   bool compress_indices) {
  draco::ExpertEncoder encoder(mesh);
  // Edgebreaker would reorder faces and vertices.
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  encoder.options().SetGlobalBool("compress_connectivity", compress_indices);
  if (quantization_bits.has_value()) encoder.SetAttributeQuantization(0, *quantization_bits);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) {
    return absl::InternalError(absl::StrCat("Draco encoder: ", status.error_msg_string()));
  }
  return std::string(buffer.data(), buffer.size());
}

}  // namespace

absl::StatusOr<std::string> EncodeDraco(const TriangleMesh& mesh,
                                        std::optional<int> quantization_bits,
                                        std::span<const std::int32_t> face_source,
                                        std::span<const Eigen::Vector3i> face_corners) {
  CCST_RETURN_IF_ERROR(Validate(mesh, quantization_bits));
  CCST_ASSIGN_OR_RETURN(const std::unique_ptr<draco::Mesh> draco_mesh,
                        ToDraco(io::ToStreamLayout(mesh)));
  io::AddFaceSource(face_source, *draco_mesh);
  io::AddFaceCorners(face_source, face_corners, *draco_mesh);
  CCST_ASSIGN_OR_RETURN(std::string stream, Encode(*draco_mesh, quantization_bits, true));
  // Decoders refuse a sequential stream with fewer than three bytes a face to come, although
  // compressed indices and quantised positions can do with less. Bytes behind the mesh are
  // ignored, so add some, unless plain indices are the shorter way.
  CCST_ASSIGN_OR_RETURN(const io::DracoHeader header, io::ReadDracoHeader(stream));
  const std::size_t wanted =
      header.data_offset +
      static_cast<std::size_t>(kDecoderBytesPerFace * static_cast<std::int64_t>(mesh.faces.size()));
  if (stream.size() >= wanted) return stream;
  CCST_ASSIGN_OR_RETURN(std::string plain, Encode(*draco_mesh, quantization_bits, false));
  if (plain.size() <= wanted) return plain;
  stream.resize(wanted, '\0');
  return stream;
}

}  // namespace ccst
