#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status.h"
#include "core/io/io_errors.h"
#include "core/io/mesh_file.h"
#include "core/io/numbers.h"
#include "core/io/path_extension.h"
#include "core/io/sample_file.h"
#include "core/io/whole_file.h"

namespace ccst {
namespace {

// The columns of x, y and z in a header line; empty where there is none of these names.
std::optional<std::array<std::size_t, 3>> FindColumns(const std::vector<std::string>& names) {
  std::array<std::size_t, 3> columns{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t at = 0;
    while (at < names.size() && absl::AsciiStrToLower(names[at]) != std::string(1, "xyz"[axis])) {
      ++at;
    }
    if (at == names.size()) return std::nullopt;
    columns[axis] = at;
  }
  return columns;
}

// One position a line; in a table, the first line may name the columns.
absl::StatusOr<TriangleMesh> ReadLines(const std::string& text, bool is_table) {
  TriangleMesh samples;
  std::array<std::size_t, 3> columns = {0, 1, 2};
  std::int64_t number = 0;
  for (const auto& line : absl::StrSplit(text, '\n')) {
    ++number;
    const auto stripped = absl::StripAsciiWhitespace(line);
    if (stripped.empty() || stripped.front() == '#') continue;
    std::vector<std::string> fields;
    for (const auto& field : absl::StrSplit(stripped, absl::ByAnyChar(is_table ? ",;" : " \t,"))) {
      const std::string token(absl::StripAsciiWhitespace(field));
      if (is_table || !token.empty()) fields.push_back(token);
    }
    if (is_table && samples.positions.empty()) {
      const auto named = FindColumns(fields);
      if (named.has_value()) {
        columns = *named;
        continue;
      }
    }
    Eigen::Vector3d position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::optional<double> value =
          columns[axis] < fields.size() ? io::ParseDouble(fields[columns[axis]]) : std::nullopt;
      if (!value.has_value() || !std::isfinite(*value)) {
        return io::Unreadable(absl::StrCat("line ", number,
                                           ": want three finite numbers x y z, got ",
                                           io::Quoted({stripped.data(), stripped.size()})));
      }
      position[static_cast<Eigen::Index>(axis)] = *value;
    }
    samples.positions.push_back(position);
  }
  if (samples.positions.empty()) return io::Empty("the file has no samples");
  return samples;
}

constexpr std::int64_t kMaxBytes = std::int64_t{2} << 30;

}  // namespace

absl::StatusOr<TriangleMesh> ReadSamplesFile(const std::string& path) {
  const auto format = SampleFormatFromPath(path);
  if (format == SampleFormat::kXyz || format == SampleFormat::kCsv) {
    CCST_ASSIGN_OR_RETURN(const std::string text, io::ReadWholeFile(path, kMaxBytes));
    auto samples = ReadLines(text, format == SampleFormat::kCsv);
    if (!samples.ok()) return io::WithPrefix(samples.status(), path + ": ");
    return samples;
  }
  MeshLimits limits;
  limits.min_faces = 0;
  CCST_ASSIGN_OR_RETURN(MeshFile file, ReadMeshFile(path, limits));
  return std::move(file.mesh);
}

}  // namespace ccst
