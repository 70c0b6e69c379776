#include "server/rpc/stream_reactor.h"

namespace ccst::server {

void OpenStreams::Add(const std::shared_ptr<Stream>& stream) {
  MutexLock lock(mutex_);
  streams_.insert(stream);
}

void OpenStreams::Remove(const std::shared_ptr<Stream>& stream) {
  MutexLock lock(mutex_);
  streams_.erase(stream);
}

void OpenStreams::PulseAll() {
  std::set<std::shared_ptr<Stream>> streams;
  {
    MutexLock lock(mutex_);
    streams = streams_;
  }
  for (const auto& stream : streams) stream->Pulse();
}

}  // namespace ccst::server
