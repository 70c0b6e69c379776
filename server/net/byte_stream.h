#pragma once

#include <cstddef>
#include <span>

#include "server/net/file_descriptor.h"

namespace ccst::server {

/// How reading or writing went.
struct Transfer {
  enum class State {
    kSome,    ///< `bytes` of them, at least one.
    kWait,    ///< Nothing at the moment.
    kEnded,   ///< Nothing more comes.
    kBroken,  ///< The connection is of no use any more.
  };
  State state = State::kWait;
  std::size_t bytes = 0;
};

/// A socket that is read and written without blocking. Not thread-safe.
class ByteStream {
 public:
  explicit ByteStream(FileDescriptor socket) : socket_(std::move(socket)) {}
  virtual ~ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  int descriptor() const { return socket_.get(); }

  /// Into `room`, which is not empty.
  virtual Transfer Read(std::span<char> room);
  /// From `bytes`, which are not empty.
  virtual Transfer Write(std::span<const char> bytes);
  /// Bytes may be read without the socket becoming readable first.
  virtual bool HasBuffered() const { return false; }
  /// The last Read() waits until the socket can be written.
  virtual bool ReadWaitsToWrite() const { return false; }
  /// Tells the other end that nothing more comes.
  virtual void FinishWriting();

 private:
  FileDescriptor socket_;
};

}  // namespace ccst::server
