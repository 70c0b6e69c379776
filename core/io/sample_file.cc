#include "core/io/sample_file.h"

#include <array>
#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status.h"
#include "core/io/atomic_file.h"
#include "core/io/draco_cloud.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/io/obj_writer.h"
#include "core/io/path_extension.h"
#include "core/io/sample_arrays.h"
#include "core/io/sample_clouds.h"
#include "core/io/sample_columns.h"
#include "core/io/sample_rows.h"

namespace ccst {
namespace {

constexpr std::array<std::pair<std::string_view, SampleFormat>, 9> kFormats = {{
    {".ply", SampleFormat::kPly},
    {".csv", SampleFormat::kCsv},
    {".xyz", SampleFormat::kXyz},
    {".obj", SampleFormat::kObj},
    {".drc", SampleFormat::kDraco},
    {".npy", SampleFormat::kNpy},
    {".npz", SampleFormat::kNpz},
    {".pcd", SampleFormat::kPcd},
    {".vtp", SampleFormat::kVtp},
}};

absl::Status Refuse(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

std::string EncodePly(const SampleSet& samples) {
  io::SampleRows rows = io::ToRows(samples);
  std::string header = absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ",
                                    samples.positions.size(), "\n");
  for (const io::RowField& field : rows.fields) {
    absl::StrAppend(&header, "property ", io::NamesOf(field.type).ply, " ", field.name, "\n");
  }
  return std::move(rows.bytes.insert(0, header + "end_header\n"));
}

std::string EncodeCsv(const SampleSet& samples) {
  const std::vector<std::string> names = io::OwnFieldNames(samples);
  const std::vector<io::SampleColumn> columns =
      io::LayOutColumns(samples.attributes, std::set<std::string>(names.begin(), names.end()));
  std::string out = absl::StrJoin(names, ",");
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
    if (!samples.face_corners.empty()) {
      for (const int corner : samples.face_corners[i]) absl::StrAppend(&out, ",", corner);
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

absl::Status CheckFloats(const SampleSet& samples) {
  for (std::size_t i = 0; i < samples.positions.size(); ++i) {
    if (samples.positions[i].cast<float>().allFinite()) continue;
    return Refuse(absl::StrCat("sample ", i, " has a coordinate that is no finite 32-bit float; ",
                               "write another format"));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> EncodeDracoSamples(const SampleSet& samples) {
  const std::size_t count = samples.positions.size();
  if (count == 0) return Refuse("there are no samples; a Draco point cloud needs one");
  if (count > std::numeric_limits<std::int32_t>::max()) {
    return Refuse(absl::StrCat(count, " samples; Draco counts to 2147483647"));
  }
  CCST_RETURN_IF_ERROR(CheckFloats(samples));
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
  if (!samples.face_corners.empty() && samples.face_corners.size() != count) {
    return Refuse(
        absl::StrCat(samples.face_corners.size(), " rows of face corners for ", count, " samples"));
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
    case SampleFormat::kNpy:
      return io::EncodeNpy(samples);
    case SampleFormat::kNpz:
      return io::EncodeNpz(samples);
    case SampleFormat::kPcd:
      CCST_RETURN_IF_ERROR(CheckFloats(samples));
      return io::EncodePcd(samples);
    case SampleFormat::kVtp:
      return io::EncodeVtp(samples);
  }
  return Refuse("unknown sample format");
}

absl::Status WriteSamplesFile(const SampleSet& samples, const std::string& path,
                              std::optional<SampleFormat> format) {
  if (!format.has_value()) format = SampleFormatFromPath(path);
  if (!format.has_value()) {
    return Refuse(path == "-" ? std::string("standard output needs a format")
                              : absl::StrCat(path, ": cannot tell the format; known are ",
                                             kSampleExtensions));
  }
  const auto bytes = EncodeSamples(samples, *format);
  if (!bytes.ok()) return io::WithPrefix(bytes.status(), path + ": ");
  return WriteFileAtomically(path, *bytes);
}

}  // namespace ccst
