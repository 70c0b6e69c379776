#include "tests/core/io/io_test_util.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ccst::testing {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

// Largest resident size [KiB] of a child that runs `action`; -1 after a crash.
std::int64_t PeakOfChild(const std::function<void()>& action) {
  const pid_t child = fork();
  if (child == 0) {
    action();
    _exit(0);
  }
  int status = 0;
  struct rusage usage = {};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? usage.ru_maxrss : -1;
}

}  // namespace

std::string WhyNotRefused(const absl::Status& status, ErrorReason reason,
                          std::initializer_list<std::string_view> message_parts) {
  if (status.ok()) return "was accepted";
  const std::string message(status.message());
  if (status.code() != absl::StatusCode::kInvalidArgument) return "other code: " + message;
  const auto found = GetErrorReason(status);
  if (!found.has_value()) return "no reason: " + message;
  if (*found != reason) return "reason " + std::string(ErrorReasonName(*found)) + ": " + message;
  for (const std::string_view part : message_parts) {
    if (message.find(part) == std::string::npos) {
      return "no '" + std::string(part) + "' in: " + message;
    }
  }
  return "";
}

std::string Difference(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.positions.size() != b.positions.size()) {
    return std::to_string(a.positions.size()) + " and " + std::to_string(b.positions.size()) +
           " vertices";
  }
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    if (std::memcmp(a.positions[i].data(), b.positions[i].data(), 3 * sizeof(double)) != 0) {
      return "vertex " + std::to_string(i);
    }
  }
  if (a.faces.size() != b.faces.size()) {
    return std::to_string(a.faces.size()) + " and " + std::to_string(b.faces.size()) + " faces";
  }
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    if (a.faces[i] != b.faces[i]) return "face " + std::to_string(i);
  }
  if (a.attributes.size() != b.attributes.size()) {
    return std::to_string(a.attributes.size()) + " and " + std::to_string(b.attributes.size()) +
           " attributes";
  }
  for (std::size_t i = 0; i < a.attributes.size(); ++i) {
    const Attribute& left = a.attributes[i];
    const Attribute& right = b.attributes[i];
    if (left.name != right.name || left.kind != right.kind || left.id != right.id ||
        left.components != right.components || left.per_corner != right.per_corner) {
      return "description of attribute " + left.name + " and " + right.name;
    }
    if (left.values.size() != right.values.size() ||
        std::memcmp(left.values.data(), right.values.data(), 4 * left.values.size()) != 0) {
      return "values of attribute " + left.name;
    }
  }
  return "";
}

TriangleMesh Shuffled(const TriangleMesh& mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<int> place(mesh.positions.size());
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  TriangleMesh result;
  result.positions.resize(mesh.positions.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    result.positions[static_cast<std::size_t>(place[i])] = mesh.positions[i];
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    const auto turn = static_cast<int>(random() % 3);
    Eigen::Vector3i moved;
    for (int k = 0; k < 3; ++k) moved[k] = place[static_cast<std::size_t>(face[(k + turn) % 3])];
    result.faces.push_back(moved);
  }
  std::shuffle(result.faces.begin(), result.faces.end(), random);
  return result;
}

TriangleMesh WithOddCoordinates(TriangleMesh mesh) {
  double step = 0.0;
  for (Eigen::Vector3d& position : mesh.positions) {
    for (double& value : position) value += 1e-3 / (1.7 + (step += 0.37));
  }
  return mesh;
}

std::int64_t PeakGrowth(const std::function<void()>& action) {
  const std::int64_t before = PeakOfChild([] {});
  const std::int64_t peak = PeakOfChild(action);
  if (before < 0 || peak < 0) return -1;
  return kSanitized ? 0 : std::max<std::int64_t>(0, peak - before) * 1024;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "ccst-io-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

void WriteBytes(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace ccst::testing
