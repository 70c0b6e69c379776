#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/io/byte_source.h"
#include "core/io/numbers.h"

namespace ccst::io {

/// Reads on through a source, of which it keeps a few kB. What goes beyond the end, or is no right
/// number, makes `failed` true and all that follows zero. Not thread-safe.
class ByteReader {
 public:
  /// `source` outlives it.
  explicit ByteReader(const ByteSource& source, std::int64_t position = 0)
      : source_(source), position_(position) {}

  /// A number, least significant byte first.
  template <typename T>
  T Fixed() {
    if (!Ensure(sizeof(T))) return T{};
    const T value = LoadBytes<T>(window_.data() + (position_ - window_begin_), std::endian::little);
    position_ += static_cast<std::int64_t>(sizeof(T));
    return value;
  }

  /// LEB128 of at most 32 bits, or 64.
  std::uint32_t Varint32();
  std::uint64_t Varint64();

  void Skip(std::uint64_t bytes);
  void MoveTo(std::int64_t position);
  /// The bytes [begin, end), wherever it stands; nothing when it failed.
  std::string Between(std::int64_t begin, std::int64_t end);

  void Fail() { failed_ = true; }
  bool failed() const { return failed_; }
  /// Why the source could not be read; OK when it could.
  const absl::Status& status() const { return status_; }
  std::int64_t position() const { return position_; }
  std::int64_t remaining() const { return failed_ ? 0 : source_.size - position_; }

 private:
  bool Ensure(std::int64_t bytes);
  std::uint64_t Varint(int most_bytes);

  const ByteSource& source_;
  std::int64_t position_;
  std::vector<char> window_;
  std::int64_t window_begin_ = 0;
  std::int64_t window_end_ = 0;
  bool failed_ = false;
  absl::Status status_;
};

}  // namespace ccst::io
