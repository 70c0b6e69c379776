#pragma once

#include <cstdint>
#include <string>

namespace ccst::server {

/// Frames of HTTP/2, made by hand after RFC 9113.
inline constexpr char kHttp2Preface[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";

inline std::string MakeFrame(int type, int flags, std::uint32_t stream,
                             const std::string& payload = "") {
  std::string frame;
  for (const int shift : {16, 8, 0}) frame += static_cast<char>(payload.size() >> shift & 0xff);
  frame += static_cast<char>(type);
  frame += static_cast<char>(flags);
  for (const int shift : {24, 16, 8, 0}) frame += static_cast<char>(stream >> shift & 0xff);
  return frame + payload;
}

inline std::string MakeData(std::uint32_t stream, const std::string& payload, bool end = false) {
  return MakeFrame(0, end ? 1 : 0, stream, payload);
}
inline std::string MakeHeaders(std::uint32_t stream, const std::string& block, bool end = true) {
  return MakeFrame(1, end ? 4 : 0, stream, block);
}
inline std::string MakeReset(std::uint32_t stream) {
  return MakeFrame(3, 0, stream, std::string("\0\0\0\x08", 4));
}
inline std::string MakeSettings() { return MakeFrame(4, 0, 0); }
inline std::string MakePing() { return MakeFrame(6, 0, 0, "12345678"); }
inline std::string MakeContinuation(std::uint32_t stream, const std::string& block,
                                    bool end = false) {
  return MakeFrame(9, end ? 4 : 0, stream, block);
}

}  // namespace ccst::server
