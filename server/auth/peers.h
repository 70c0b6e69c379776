#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "server/auth/peer.h"
#include "server/base/mutex.h"

namespace ccst::server {

/// Who is at the other end of each open connection. Thread-safe.
///
/// Connections are accepted by `server/net` and handed to gRPC as local sockets, so what gRPC calls
/// a peer is a name that is given out here.
class Peers {
 public:
  /// Keeps a peer findable until it goes away. Must not outlive its Peers.
  class Entry {
   public:
    Entry(Peers& peers, std::string name) : peers_(peers), name_(std::move(name)) {}
    ~Entry() { peers_.Remove(name_); }
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

    const std::string& name() const { return name_; }

   private:
    Peers& peers_;
    const std::string name_;
  };

  /// The name is of letters, digits and dashes, below 64 bytes, and given out once: neither a later
  /// connection nor another program of the machine can have it.
  std::unique_ptr<Entry> Add(Peer peer) ABSL_LOCKS_EXCLUDED(mutex_);

  /// Null when the connection of that name is gone, or there never was one.
  std::shared_ptr<const Peer> Find(std::string_view name) const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  void Remove(const std::string& name) ABSL_LOCKS_EXCLUDED(mutex_);

  mutable Mutex mutex_;
  std::uint64_t added_ ABSL_GUARDED_BY(mutex_) = 0;
  std::unordered_map<std::string, std::shared_ptr<const Peer>> peers_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
