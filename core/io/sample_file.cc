#include "core/io/sample_file.h"

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/atomic_file.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/io/path_extension.h"
#include "core/io/sample_columns.h"
#include "draco/compression/expert_encode.h"
#include "draco/core/encoder_buffer.h"
#include "draco/point_cloud/point_cloud.h"

namespace ccst {
namespace {

constexpr std::array<std::pair<std::string_view, SampleFormat>, 5> kFormats = {{
    {".ply", SampleFormat::kPly},
    {".csv", SampleFormat::kCsv},
    {".xyz", SampleFormat::kXyz},
    {".obj", SampleFormat::kObj},
    {".drc", SampleFormat::kDraco},
}};

absl::Status Refuse(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

std::string EncodePly(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  std::string out =
      absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", count,
                   "\nproperty double x\nproperty double y\nproperty double z\n"
                   "property float nx\nproperty float ny\nproperty float nz\nproperty int face\n"
                   "property double bary_u\nproperty double bary_v\n");
  std::size_t record_bytes = 3 * 8 + 3 * 4 + 4 + 2 * 8;
  const std::vector<io::SampleColumn> columns = io::LayOutColumns(samples.attributes);
  for (const io::SampleColumn& column : columns) {
    absl::StrAppend(&out, "property ", column.is_color() ? "uchar " : "float ", column.name, "\n");
    record_bytes += column.is_color() ? 1 : 4;
  }
  out += "end_header\n";
  out.reserve(out.size() + record_bytes * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const double value : samples.positions[i]) io::AppendLittleEndian(out, value);
    for (const double value : samples.normals[i]) {
      io::AppendLittleEndian(out, static_cast<float>(value));
    }
    io::AppendLittleEndian(out, samples.faces[i]);
    for (const double value : samples.barycentrics[i]) io::AppendLittleEndian(out, value);
    for (const io::SampleColumn& column : columns) {
      if (column.is_color()) {
        io::AppendLittleEndian(out, io::ToByte(column.Value(i)));
      } else {
        io::AppendLittleEndian(out, column.Value(i));
      }
    }
  }
  return out;
}

std::string EncodeCsv(const SampleSet& samples) {
  const std::vector<io::SampleColumn> columns = io::LayOutColumns(samples.attributes);
  std::string out = "x,y,z,nx,ny,nz,face,bary_u,bary_v";
  for (const io::SampleColumn& column : columns) absl::StrAppend(&out, ",", column.name);
  out += '\n';
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    for (const double value : samples.positions[i]) {
      io::AppendDouble(out, value);
      out += ',';
    }
    for (const double value : samples.normals[i]) {
      io::AppendDouble(out, value);
      out += ',';
    }
    io::AppendInteger(out, samples.faces[i]);
    for (const double value : samples.barycentrics[i]) {
      out += ',';
      io::AppendDouble(out, value);
    }
    for (const io::SampleColumn& column : columns) {
      out += ',';
      io::AppendFloat(out, column.Value(i));
    }
    out += '\n';
  }
  return out;
}

std::string EncodePositions(const SampleSet& samples, std::string_view line_start) {
  std::string out;
  for (const Eigen::Vector3d& position : samples.positions) {
    out += line_start;
    for (int axis = 0; axis < 3; ++axis) {
      io::AppendDouble(out, position[axis]);
      out += axis < 2 ? ' ' : '\n';
    }
  }
  return out;
}

absl::StatusOr<std::string> EncodeDracoPoints(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  if (count == 0) return Refuse("there are no samples; a Draco point cloud needs one");
  if (count > std::numeric_limits<std::int32_t>::max()) {
    return Refuse(absl::StrCat(count, " samples; Draco counts to 2147483647"));
  }
  draco::PointCloud cloud;
  cloud.set_num_points(static_cast<std::uint32_t>(count));
  const auto add = [&](draco::GeometryAttribute::Type type,
                       const std::vector<Eigen::Vector3d>& vectors) -> absl::Status {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
    const int id =
        cloud.AddAttribute(attribute, /*identity_mapping=*/true, static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f vector = vectors[i].cast<float>();
      if (!vector.allFinite()) {
        return Refuse(absl::StrCat("sample ", i, " has a coordinate that is no finite 32-bit ",
                                   "float; write another format"));
      }
      cloud.attribute(id)->SetAttributeValue(
          draco::AttributeValueIndex(static_cast<std::uint32_t>(i)), vector.data());
    }
    return absl::OkStatus();
  };
  CCST_RETURN_IF_ERROR(add(draco::GeometryAttribute::POSITION, samples.positions));
  CCST_RETURN_IF_ERROR(add(draco::GeometryAttribute::NORMAL, samples.normals));
  draco::ExpertEncoder encoder(cloud);
  // The k-d tree method would reorder the samples.
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  const draco::Status status = encoder.EncodeToBuffer(&buffer);
  if (!status.ok()) {
    return absl::InternalError(absl::StrCat("Draco encoder: ", status.error_msg_string()));
  }
  return std::string(buffer.data(), buffer.size());
}

}  // namespace

std::optional<SampleFormat> SampleFormatFromPath(std::string_view path) {
  return io::FindByExtension(path, kFormats);
}

absl::StatusOr<std::string> EncodeSamples(const SampleSet& samples, SampleFormat format) {
  const std::size_t count = samples.positions.size();
  if (samples.normals.size() != count || samples.faces.size() != count ||
      samples.barycentrics.size() != count) {
    return Refuse(absl::StrCat(count, " positions, ", samples.normals.size(), " normals, ",
                               samples.faces.size(), " faces and ", samples.barycentrics.size(),
                               " barycentrics; there must be as many of each"));
  }
  for (const Attribute& attribute : samples.attributes) {
    if (attribute.components >= 1 &&
        attribute.values.size() == count * static_cast<std::size_t>(attribute.components)) {
      continue;
    }
    return Refuse(absl::StrCat("attribute '", attribute.name, "' has ", attribute.values.size(),
                               " values in rows of ", attribute.components, " for ", count,
                               " samples"));
  }
  switch (format) {
    case SampleFormat::kPly:
      return EncodePly(samples);
    case SampleFormat::kCsv:
      return EncodeCsv(samples);
    case SampleFormat::kXyz:
      return EncodePositions(samples, "");
    case SampleFormat::kObj:
      return EncodePositions(samples, "v ");
    case SampleFormat::kDraco:
      return EncodeDracoPoints(samples);
  }
  return Refuse("unknown sample format");
}

absl::Status WriteSamplesFile(const SampleSet& samples, const std::string& path,
                              std::optional<SampleFormat> format) {
  if (!format.has_value()) format = SampleFormatFromPath(path);
  if (!format.has_value()) {
    return Refuse(path == "-" ? std::string("standard output needs a format: ply, csv, xyz, obj "
                                            "or drc")
                              : absl::StrCat(path, ": cannot tell the format; known are .ply ",
                                             ".csv .xyz .obj .drc"));
  }
  const auto bytes = EncodeSamples(samples, *format);
  if (!bytes.ok()) return io::WithPrefix(bytes.status(), path + ": ");
  return WriteFileAtomically(path, *bytes);
}

}  // namespace ccst
