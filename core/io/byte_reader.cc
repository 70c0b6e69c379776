#include "core/io/byte_reader.h"

#include <algorithm>
#include <limits>

namespace ccst::io {
namespace {

constexpr std::int64_t kWindow = std::int64_t{16} << 10;

}  // namespace

std::uint32_t ByteReader::Varint32() {
  const std::uint64_t value = Varint(5);
  if (value > std::numeric_limits<std::uint32_t>::max()) Fail();
  return failed_ ? 0 : static_cast<std::uint32_t>(value);
}

std::uint64_t ByteReader::Varint64() { return Varint(10); }

std::uint64_t ByteReader::Varint(int most_bytes) {
  std::uint64_t value = 0;
  for (int i = 0; i < most_bytes; ++i) {
    const auto byte = Fixed<std::uint8_t>();
    value |= std::uint64_t{byte & 0x7fu} << (7 * i);
    if ((byte & 0x80u) == 0) return failed_ ? 0 : value;
  }
  Fail();
  return 0;
}

void ByteReader::Skip(std::uint64_t bytes) {
  if (bytes > static_cast<std::uint64_t>(remaining())) return Fail();
  position_ += static_cast<std::int64_t>(bytes);
}

void ByteReader::MoveTo(std::int64_t position) {
  if (position < 0 || position > source_.size) return Fail();
  position_ = position;
}

std::string ByteReader::Between(std::int64_t begin, std::int64_t end) {
  std::string bytes(failed_ ? 0 : static_cast<std::size_t>(end - begin), '\0');
  if (bytes.empty()) return bytes;
  status_.Update(source_.read(begin, bytes));
  if (status_.ok()) return bytes;
  Fail();
  return {};
}

bool ByteReader::Ensure(std::int64_t bytes) {
  if (bytes > remaining()) Fail();
  if (failed_) return false;
  if (position_ >= window_begin_ && position_ + bytes <= window_end_) return true;
  const std::int64_t size = std::min(kWindow, remaining());
  window_.resize(static_cast<std::size_t>(size));
  window_begin_ = position_;
  window_end_ = position_ + size;
  status_.Update(source_.read(position_, window_));
  if (!status_.ok()) Fail();
  return !failed_;
}

}  // namespace ccst::io
