#include "server/auth/peers.h"

#include <array>
#include <utility>

#include <openssl/rand.h>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace ccst::server {
namespace {

constexpr std::size_t kRandomBytes = 8;

// So that no other program can take the name of the next socket before it is made.
std::string RandomDigits() {
  std::array<unsigned char, kRandomBytes> random = {};
  RAND_bytes(random.data(), static_cast<int>(random.size()));
  return absl::BytesToHexString(
      absl::string_view(reinterpret_cast<const char*>(random.data()), random.size()));
}

}  // namespace

std::unique_ptr<Peers::Entry> Peers::Add(Peer peer) {
  const std::string random = RandomDigits();
  const MutexLock lock(mutex_);
  // The number makes it the only one, the random digits make it hard to guess.
  const std::string name = absl::StrCat("ccst-", ++added_, "-", random);
  peers_[name] = std::make_shared<const Peer>(std::move(peer));
  return std::make_unique<Entry>(*this, name);
}

std::shared_ptr<const Peer> Peers::Find(std::string_view name) const {
  const MutexLock lock(mutex_);
  const auto found = peers_.find(std::string(name));
  return found == peers_.end() ? nullptr : found->second;
}

void Peers::Remove(const std::string& name) {
  const MutexLock lock(mutex_);
  peers_.erase(name);
}

}  // namespace ccst::server
