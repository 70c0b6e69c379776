#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace ccst::io {

/// The number that all of `token` spells, correctly rounded, whatever the locale; `inf` and
/// `nan` in any case are numbers too, and what is too large is infinite. Empty otherwise.
std::optional<double> ParseDouble(std::string_view token);

/// The decimal integer that all of `token` spells; empty otherwise or when it does not fit.
std::optional<std::int64_t> ParseInteger(std::string_view token);

/// Appends the shortest text that reads back as the same double.
void AppendDouble(std::string& out, double value);

/// Appends the shortest text that reads back as the same float.
void AppendFloat(std::string& out, float value);

void AppendInteger(std::string& out, std::int64_t value);

/// `token` fit for an error message: cut, quoted, unprintable bytes replaced.
std::string Quoted(std::string_view token);

/// The 32-bit float nearest to `value`. GCC 12 drops a conversion to float and back where it
/// vectorises both, at -O2 and -O3; that it is stored in between keeps it.
inline double RoundedToFloat(double value) {
  const volatile float rounded = static_cast<float>(value);
  return rounded;
}

/// Appends the bytes of `value`, least significant first.
template <typename T>
void AppendLittleEndian(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if constexpr (std::endian::native == std::endian::big) {
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  }
  out.append(bytes, sizeof(T));
}

/// The value whose bytes lie at `bytes`, in the given order. Reads sizeof(T) bytes.
template <typename T>
T LoadBytes(const char* bytes, std::endian order) {
  char copy[sizeof(T)];
  std::memcpy(copy, bytes, sizeof(T));
  if (order != std::endian::native) {
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(copy[i], copy[sizeof(T) - 1 - i]);
  }
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

}  // namespace ccst::io
