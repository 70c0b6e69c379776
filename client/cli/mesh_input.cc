#include "client/cli/mesh_input.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/draco_mesh.h"
#include "core/io/mesh_limits.h"

namespace ccst::cli {
namespace {

absl::StatusOr<std::string> ReadStandardInput(std::int64_t max_bytes) {
  std::string bytes;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t got = read(STDIN_FILENO, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      return absl::UnknownError(absl::StrCat("standard input: ", std::strerror(errno)));
    }
    if (got == 0) return bytes;
    if (static_cast<std::int64_t>(bytes.size()) + got > max_bytes) {
      return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kLimitExceeded,
                       absl::StrCat("standard input holds more than ", max_bytes, " bytes"));
    }
    bytes.append(buffer, static_cast<std::size_t>(got));
  }
}

absl::StatusOr<MeshFile> ReadFile(const std::string& path) {
  if (path != "-") return ReadMeshFile(path);
  CCST_ASSIGN_OR_RETURN(const std::string bytes, ReadStandardInput(MeshLimits().max_bytes));
  auto file = ReadMesh(bytes, RecogniseFormat(bytes));
  if (file.ok()) return file;
  absl::Status status(file.status().code(),
                      absl::StrCat("standard input: ", file.status().message()));
  file.status().ForEachPayload([&status](absl::string_view url, const absl::Cord& payload) {
    status.SetPayload(url, payload);
  });
  return status;
}

double LargestMove(const TriangleMesh& before, const TriangleMesh& after) {
  double largest = 0.0;
  for (std::size_t f = 0; f < before.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      largest = std::max(
          largest,
          (before.positions[before.faces[f][k]] - after.positions[after.faces[f][k]]).norm());
    }
  }
  return largest;
}

// What is left behind white space and, for the formats that have them, comment lines.
std::string_view SkipBlank(std::string_view text, bool comments) {
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    if (!comments || !text.starts_with('#')) return text;
    text.remove_prefix(std::min(text.find('\n'), text.size()));
  }
}

// OFF has its attributes in front of its name: ST, C and N, in this order.
bool IsOff(std::string_view text) {
  for (const std::string_view prefix : {"ST", "C", "N"}) {
    if (text.starts_with(prefix)) text.remove_prefix(prefix.size());
  }
  return text.starts_with("OFF");
}

// Binary STL says how many triangles of 50 bytes follow its 80 bytes of anything.
bool IsBinaryStl(std::string_view bytes) {
  constexpr std::size_t kHeader = 84;
  if (bytes.size() < kHeader) return false;
  std::uint32_t count = 0;
  for (int i = 0; i < 4; ++i) {
    count |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[80 + i])) << (8 * i);
  }
  return bytes.size() == kHeader + std::uint64_t{50} * count;
}

}  // namespace

std::string ReportText(const ReadReport& report) {
  std::string text;
  const auto say = [&text](std::int64_t count, const char* what) {
    if (count > 0) absl::StrAppend(&text, count, " ", what, "\n");
  };
  say(report.faces_skipped, "faces with fewer than three corners are skipped");
  say(report.polygons_self_crossing,
      "polygons cross themselves and are cut as well as they can be");
  say(report.vertices_not_finite, "vertices without finite coordinates belong to no face");
  for (const std::string& what : report.ignored)
    absl::StrAppend(&text, "passed over: ", what, "\n");
  return text;
}

void NameOwnFaces(const std::vector<std::int32_t>& face_source,
                  const std::vector<Eigen::Vector3i>& face_corners, SampleSet& samples) {
  if (face_source.empty()) return;
  const bool has_polygons =
      std::adjacent_find(face_source.begin(), face_source.end()) != face_source.end();
  if (has_polygons) samples.face_corners.reserve(samples.faces.size());
  for (std::int32_t& face : samples.faces) {
    const auto triangle = static_cast<std::size_t>(face);
    face = face_source[triangle];
    if (!has_polygons) continue;
    if (!face_corners.empty()) {
      samples.face_corners.push_back(face_corners[triangle]);
      continue;
    }
    const auto first = std::lower_bound(face_source.begin(), face_source.end(), face);
    const auto in_face = static_cast<int>(triangle) - static_cast<int>(first - face_source.begin());
    samples.face_corners.emplace_back(0, in_face + 1, in_face + 2);
  }
}

MeshFormat RecogniseFormat(std::string_view bytes) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  if (bytes.starts_with("DRACO")) return MeshFormat::kDraco;
  if (bytes.starts_with("ply")) return MeshFormat::kPly;
  if (bytes.starts_with("glTF") || SkipBlank(bytes, false).starts_with('{')) {
    return MeshFormat::kGltf;
  }
  if (bytes.starts_with("solid") || IsBinaryStl(bytes)) return MeshFormat::kStl;
  if (IsOff(SkipBlank(bytes, true))) return MeshFormat::kOff;
  return MeshFormat::kObj;
}

absl::StatusOr<MeshInput> ReadMeshInput(const std::string& path,
                                        std::optional<int> quantization_bits, Transport transport) {
  MeshInput input;
  CCST_ASSIGN_OR_RETURN(input.file, ReadFile(path));
  input.origin = ChooseOrigin(input.file.mesh);
  CCST_ASSIGN_OR_RETURN(input.wire, ToWirePrecision(input.file.mesh, input.origin));
  // The encoding drops vertices of no face where they are too many; then, and when it moves
  // vertices, only decoding tells what a server sees.
  const bool is_exact =
      !quantization_bits.has_value() && input.wire.positions.size() <= 3 * input.wire.faces.size();
  if (is_exact && transport == Transport::kLocal) return input;
  CCST_ASSIGN_OR_RETURN(input.draco, EncodeDraco(input.wire, quantization_bits,
                                                 input.file.face_source, input.file.face_corners));
  if (!is_exact) {
    CCST_ASSIGN_OR_RETURN(TriangleMesh decoded, DecodeDraco(input.draco));
    input.max_move = LargestMove(input.wire, decoded);
    input.wire = std::move(decoded);
  }
  return input;
}

}  // namespace ccst::cli
