#include "core/io/sample_file.h"

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/atomic_file.h"
#include "core/io/draco_cloud.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/io/obj_writer.h"
#include "core/io/path_extension.h"
#include "core/io/sample_columns.h"

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

std::vector<io::SampleColumn> Columns(const SampleSet& samples) {
  return io::LayOutColumns(samples.attributes,
                           {"x", "y", "z", "nx", "ny", "nz", "face", "bary_u", "bary_v"});
}

std::string EncodePly(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  std::string out =
      absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", count,
                   "\nproperty double x\nproperty double y\nproperty double z\n"
                   "property float nx\nproperty float ny\nproperty float nz\nproperty int face\n"
                   "property double bary_u\nproperty double bary_v\n");
  const std::vector<io::SampleColumn> columns = Columns(samples);
  io::AppendPlyProperties(out, columns);
  out += "end_header\n";
  out.reserve(out.size() + (3 * 8 + 3 * 4 + 4 + 2 * 8 + io::PlyBytes(columns)) * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (const double value : samples.positions[i]) io::AppendLittleEndian(out, value);
    for (const double value : samples.normals[i]) {
      io::AppendLittleEndian(out, static_cast<float>(value));
    }
    io::AppendLittleEndian(out, samples.faces[i]);
    for (const double value : samples.barycentrics[i]) io::AppendLittleEndian(out, value);
    io::AppendPlyValues(out, columns, i);
  }
  return out;
}

std::string EncodeCsv(const SampleSet& samples) {
  const std::vector<io::SampleColumn> columns = Columns(samples);
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

std::string EncodeXyz(const SampleSet& samples) {
  std::string out;
  for (const Eigen::Vector3d& position : samples.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      io::AppendDouble(out, position[axis]);
      out += axis < 2 ? ' ' : '\n';
    }
  }
  return out;
}

absl::StatusOr<std::string> EncodeDracoSamples(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  if (count == 0) return Refuse("there are no samples; a Draco point cloud needs one");
  if (count > std::numeric_limits<std::int32_t>::max()) {
    return Refuse(absl::StrCat(count, " samples; Draco counts to 2147483647"));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (samples.positions[i].cast<float>().allFinite()) continue;
    return Refuse(absl::StrCat("sample ", i, " has a coordinate that is no finite 32-bit float; ",
                               "write another format"));
  }
  return io::EncodeDracoCloud(samples.positions, samples.normals, samples.attributes);
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
    if (!attribute.per_corner && attribute.components >= 1 && attribute.components <= 4 &&
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
      return EncodeXyz(samples);
    case SampleFormat::kObj:
      return io::EncodeObj(samples.positions, {}, samples.attributes);
    case SampleFormat::kDraco:
      return EncodeDracoSamples(samples);
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
