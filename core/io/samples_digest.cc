#include "core/io/samples_digest.h"

#include <cstdint>
#include <string_view>

#include "core/base/assert.h"
#include "core/base/sha256.h"
#include "core/io/numbers.h"

namespace ccst {
namespace {

// Feeds the layout in pieces, so that it never exists as a whole.
class Layout {
 public:
  template <typename T>
  void Add(T value) {
    io::AppendLittleEndian(pending_, value);
    if (pending_.size() >= kFlushBytes) Flush();
  }

  void Add(std::string_view bytes) { pending_ += bytes; }

  std::string Digest() {
    Flush();
    return hash_.Finish();
  }

 private:
  static constexpr std::size_t kFlushBytes = std::size_t{1} << 16;

  void Flush() {
    hash_.Add(pending_);
    pending_.clear();
  }

  Sha256 hash_;
  std::string pending_;
};

}  // namespace

std::string SamplesDigest(const SampleSet& samples) {
  CCST_ASSERT(samples.faces.size() == samples.barycentrics.size());
  constexpr std::string_view kMagic("ccst-samples-1\0", 15);
  Layout layout;
  layout.Add(kMagic);
  layout.Add(static_cast<std::uint64_t>(samples.faces.size()));
  for (const std::int32_t face : samples.faces) layout.Add(face);
  for (const Eigen::Vector2d& barycentric : samples.barycentrics) {
    layout.Add(barycentric.x());
    layout.Add(barycentric.y());
  }
  layout.Add(static_cast<std::uint64_t>(samples.triangles.size()));
  for (const Eigen::Vector3i& triangle : samples.triangles) {
    for (const int corner : triangle) layout.Add(std::int32_t{corner});
  }
  return layout.Digest();
}

}  // namespace ccst
