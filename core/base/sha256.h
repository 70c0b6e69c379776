#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace ccst {

/// SHA-256 (FIPS 180-4) of bytes that arrive in pieces, by OpenSSL.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void Add(std::string_view bytes);

  /// The digest as 64 lowercase hexadecimal digits; once.
  std::string Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The digest of `bytes` alone.
std::string Sha256Of(std::string_view bytes);

/// True for 64 lowercase hexadecimal digits.
bool IsSha256(std::string_view text);

}  // namespace ccst
