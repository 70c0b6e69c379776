#include "server/net/byte_stream.h"

#include <cerrno>

#include <sys/socket.h>

namespace ccst::server {
namespace {

bool IsTemporary(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

Transfer Failed() {
  return {.state = IsTemporary(errno) ? Transfer::State::kWait : Transfer::State::kBroken};
}

}  // namespace

Transfer ByteStream::Read(std::span<char> room) {
  const ssize_t count = recv(descriptor(), room.data(), room.size(), 0);
  if (count < 0) return Failed();
  if (count == 0) return {.state = Transfer::State::kEnded};
  return {.state = Transfer::State::kSome, .bytes = static_cast<std::size_t>(count)};
}

Transfer ByteStream::Write(std::span<const char> bytes) {
  const ssize_t count = send(descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (count <= 0) return Failed();
  return {.state = Transfer::State::kSome, .bytes = static_cast<std::size_t>(count)};
}

void ByteStream::FinishWriting() { shutdown(descriptor(), SHUT_WR); }

}  // namespace ccst::server
