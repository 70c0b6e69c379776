#include "core/io/samples_digest.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include <openssl/evp.h>

#include "core/io/numbers.h"

namespace ccst {
namespace {

// Feeds SHA-256 in pieces, so that the layout never exists as a whole.
class Hasher {
 public:
  Hasher() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }

  template <typename T>
  void Add(T value) {
    io::AppendLittleEndian(pending_, value);
    if (pending_.size() >= kFlushBytes) Flush();
  }

  void Add(std::string_view bytes) { pending_ += bytes; }

  std::string Finish() {
    Flush();
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest = {};
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) {
      text += "0123456789abcdef"[digest[i] >> 4];
      text += "0123456789abcdef"[digest[i] & 15];
    }
    return text;
  }

 private:
  static constexpr std::size_t kFlushBytes = std::size_t{1} << 16;

  void Flush() {
    EVP_DigestUpdate(context_.get(), pending_.data(), pending_.size());
    pending_.clear();
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
  std::string pending_;
};

}  // namespace

std::string SamplesDigest(const SampleSet& samples) {
  constexpr std::string_view kMagic("ccst-samples-1\0", 15);
  Hasher hasher;
  hasher.Add(kMagic);
  hasher.Add(static_cast<std::uint64_t>(samples.faces.size()));
  for (const std::int32_t face : samples.faces) hasher.Add(face);
  for (const Eigen::Vector2d& barycentric : samples.barycentrics) {
    hasher.Add(barycentric.x());
    hasher.Add(barycentric.y());
  }
  hasher.Add(static_cast<std::uint64_t>(samples.triangles.size()));
  for (const Eigen::Vector3i& triangle : samples.triangles) {
    for (const int corner : triangle) hasher.Add(std::int32_t{corner});
  }
  return hasher.Finish();
}

}  // namespace ccst
