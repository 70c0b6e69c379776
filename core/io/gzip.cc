#include "core/io/gzip.h"

#include <algorithm>
#include <limits>

#include <zlib.h>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/io/io_errors.h"

namespace ccst::io {

bool IsGzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b\x08"); }

absl::StatusOr<std::string> DecompressGzip(std::string_view bytes, std::int64_t max_bytes) {
  constexpr std::size_t kStep = std::size_t{1} << 16;
  constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  z_stream stream = {};
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) {
    return absl::ResourceExhaustedError("there is no memory to decompress the file");
  }
  const auto end = absl::MakeCleanup([&stream] { inflateEnd(&stream); });
  std::string out;
  std::size_t given = 0;
  std::size_t size = 0;
  while (true) {
    if (stream.avail_in == 0 && given < bytes.size()) {
      const std::size_t piece = std::min(bytes.size() - given, kMostAtOnce);
      // zlib takes no pointer to const, but does not write there.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + given));
      stream.avail_in = static_cast<uInt>(piece);
      given += piece;
    }
    out.resize(size + std::max(kStep, size / 2));
    const std::size_t room = std::min(out.size() - size, kMostAtOnce);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + size);
    stream.avail_out = static_cast<uInt>(room);
    const int result = inflate(&stream, Z_NO_FLUSH);
    size += room - stream.avail_out;
    if (static_cast<std::int64_t>(size) > max_bytes) {
      return OverLimit(
          absl::StrCat("more than ", max_bytes, " bytes once decompressed, the most ", "accepted"));
    }
    const bool is_all = stream.avail_in == 0 && given == bytes.size();
    if (result == Z_STREAM_END) {
      // Zeros may pad the end; another member may follow.
      const std::string_view rest = bytes.substr(given - stream.avail_in);
      if (is_all || !IsGzip(rest)) break;
      if (inflateReset(&stream) != Z_OK) return Unreadable("the gzip file is damaged");
      continue;
    }
    if (result == Z_MEM_ERROR) {
      return absl::ResourceExhaustedError("there is no memory to decompress the file");
    }
    if (result != Z_OK && result != Z_BUF_ERROR) return Unreadable("the gzip file is damaged");
    if (is_all && stream.avail_out > 0) return Unreadable("the gzip file is cut off");
  }
  out.resize(size);
  return out;
}

}  // namespace ccst::io
