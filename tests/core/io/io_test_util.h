#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "core/base/status.h"
#include "core/io/mesh_file.h"
#include "core/mesh/triangle_mesh.h"

namespace ccst::testing {

/// Status of what a StatusOr test expects to fail: code INVALID_ARGUMENT, `reason`, and every
/// one of the parts in its message. Returns what is wrong, empty when nothing is.
std::string WhyNotRefused(const absl::Status& status, ErrorReason reason,
                          std::initializer_list<std::string_view> message_parts);

/// Empty when both have the same faces and attributes and bit for bit the same positions.
std::string Difference(const TriangleMesh& a, const TriangleMesh& b);

/// The faces in another order, their corners turned, the vertices in another order.
TriangleMesh Shuffled(const TriangleMesh& mesh, std::uint32_t seed);

/// Every coordinate moved by a different odd amount, so that no two have simple bits.
TriangleMesh WithOddCoordinates(TriangleMesh mesh);

/// Memory [byte] that `action` makes a child process of this one grow by; -1 when the child
/// crashed. Under a sanitizer, which takes memory of its own, 0.
std::int64_t PeakGrowth(const std::function<void()>& action);

/// A new empty folder, removed with all in it at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

std::string ReadBytes(const std::string& path);
void WriteBytes(const std::string& path, std::string_view bytes);

}  // namespace ccst::testing

/// Expects a StatusOr or Status to be refused with a reason and a message that has these parts.
#define EXPECT_REFUSED(result, reason, ...)                                               \
  EXPECT_EQ("", ::ccst::testing::WhyNotRefused(::ccst::testing::ToStatus(result), reason, \
                                               {__VA_ARGS__}))

namespace ccst::testing {
inline absl::Status ToStatus(const absl::Status& status) { return status; }
template <typename T>
absl::Status ToStatus(const absl::StatusOr<T>& result) {
  return result.status();
}
}  // namespace ccst::testing
