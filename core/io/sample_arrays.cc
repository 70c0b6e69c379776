#include "core/io/sample_arrays.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <zip.h>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/numbers.h"
#include "core/io/sample_rows.h"

namespace ccst::io {
namespace {

// Magic, version 2.0, the header padded so that the values begin at a multiple of 64 bytes.
// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
std::string NpyHeader(const std::string& type, const std::string& shape) {
  constexpr std::size_t kAlignment = 64;
  std::string text =
      absl::StrCat("{'descr': ", type, ", 'fortran_order': False, 'shape': (", shape, "), }");
  std::string header("\x93NUMPY\x02\x00", 8);
  const std::size_t before = header.size() + sizeof(std::uint32_t);
  text.append(kAlignment - 1 - (before + text.size()) % kAlignment, ' ');
  text += '\n';
  AppendLittleEndian(header, static_cast<std::uint32_t>(text.size()));
  return header + text;
}

// `width` 0 for an array of one dimension.
std::string Npy(const char* type, std::size_t count, int width, const std::string& values) {
  const std::string shape =
      width == 0 ? absl::StrCat(count, ",") : absl::StrCat(count, ", ", width);
  return NpyHeader(absl::StrCat("'", type, "'"), shape) + values;
}

absl::Status ZipError(zip_error_t* error) {
  const std::string message = zip_error_strerror(error);
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kOutOfMemory,
                   absl::StrCat("the arrays cannot be put together: ", message));
}

using Member = std::pair<std::string, std::string>;  // Name and contents.

// A zip archive whose members are stored as they are, dated like the first ones there were.
absl::StatusOr<std::string> Zip(const std::vector<Member>& members) {
  zip_error_t error;
  zip_error_init(&error);
  const absl::Cleanup end_error = [&error] { zip_error_fini(&error); };
  zip_source_t* const source = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (source == nullptr) return ZipError(&error);
  zip_source_keep(source);
  const absl::Cleanup free_source = [source] { zip_source_free(source); };
  zip_t* const archive = zip_open_from_source(source, ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    zip_source_free(source);
    return ZipError(&error);
  }
  absl::Cleanup discard = [archive] { zip_discard(archive); };
  for (const auto& [name, contents] : members) {
    zip_source_t* const member =
        zip_source_buffer(archive, contents.data(), contents.size(), /*freep=*/0);
    if (member == nullptr) return ZipError(zip_get_error(archive));
    const zip_int64_t index = zip_file_add(archive, name.c_str(), member, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(member);
      return ZipError(zip_get_error(archive));
    }
    const auto at = static_cast<zip_uint64_t>(index);
    constexpr zip_uint16_t kFirstDay = (1 << 5) | 1;  // 1980-01-01.
    if (zip_set_file_compression(archive, at, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(archive, at, 0, kFirstDay, 0) != 0) {
      return ZipError(zip_get_error(archive));
    }
  }
  if (zip_close(archive) != 0) return ZipError(zip_get_error(archive));
  std::move(discard).Cancel();

  zip_stat_t facts;
  if (zip_source_stat(source, &facts) != 0 || zip_source_open(source) != 0) {
    return ZipError(zip_source_error(source));
  }
  std::string bytes(facts.size, '\0');
  const zip_int64_t read = zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  if (read != static_cast<zip_int64_t>(bytes.size())) return ZipError(zip_source_error(source));
  return bytes;
}

}  // namespace

std::string EncodeNpy(const SampleSet& samples) {
  SampleRows rows = ToRows(samples);
  std::string type = "[";
  for (const RowField& field : rows.fields) {
    absl::StrAppend(&type, "('", field.name, "', '", NamesOf(field.type).numpy, "'), ");
  }
  type += ']';
  const std::string header = NpyHeader(type, absl::StrCat(rows.count(), ","));
  return std::move(rows.bytes.insert(0, header));
}

absl::StatusOr<std::string> EncodeNpz(const SampleSet& samples) {
  const SampleRows rows = ToRows(samples);
  const std::size_t count = rows.count();
  std::vector<Member> members;
  const auto add = [&](const std::string& name, std::size_t first, int width) {
    const auto fields = static_cast<std::size_t>(std::max(1, width));
    members.emplace_back(name + ".npy", Npy(NamesOf(rows.fields[first].type).numpy, count, width,
                                            rows.Slice(first, fields)));
  };
  add("positions", kPositionField, 3);
  add("normals", kNormalField, 3);
  add("faces", kFaceField, 0);
  add("barycentrics", kBarycentricField, 2);
  std::string triangles;
  triangles.reserve(samples.triangles.size() * 3 * sizeof(std::int32_t));
  for (const Eigen::Vector3i& triangle : samples.triangles) {
    for (const int corner : triangle) AppendLittleEndian(triangles, corner);
  }
  members.emplace_back("triangles.npy", Npy("<i4", samples.triangles.size(), 3, triangles));
  std::size_t next = kFurtherFields;
  if (!samples.face_corners.empty()) {
    add("face_corners", next, 3);
    next += 3;
  }
  std::set<std::string> taken;
  for (const Member& member : members) taken.insert(member.first);
  for (; next < rows.fields.size(); ++next) {
    std::string name = rows.fields[next].name;
    for (int copy = 2; !taken.insert(name + ".npy").second; ++copy) {
      name = absl::StrCat(rows.fields[next].name, "_", copy);
    }
    add(name, next, 0);
  }
  return Zip(members);
}

}  // namespace ccst::io
