#include "server/net/connection_limits.h"

#include <cstddef>

#include "absl/strings/str_cat.h"

namespace ccst::server {
namespace {

// Addresses without a connection are remembered only while they owe time.
constexpr std::size_t kAddressesPerConnection = 2;

}  // namespace

ConnectionLimits::ConnectionLimits(int max_connections, int max_per_address)
    : max_connections_(max_connections), max_per_address_(max_per_address) {}

ConnectionLimits::~ConnectionLimits() = default;

absl::StatusOr<std::unique_ptr<ConnectionLimits::Place>> ConnectionLimits::Take() {
  const MutexLock lock(mutex_);
  if (open_ >= max_connections_) {
    return absl::ResourceExhaustedError(
        absl::StrCat("there are ", max_connections_, " connections already"));
  }
  ++open_;
  return std::make_unique<Place>(*this);
}

std::unique_ptr<ConnectionLimits::Place> ConnectionLimits::TakeBeyond() {
  const MutexLock lock(mutex_);
  ++open_;
  return std::make_unique<Place>(*this);
}

int ConnectionLimits::open() const {
  const MutexLock lock(mutex_);
  return open_;
}

std::size_t ConnectionLimits::known_addresses() const {
  const MutexLock lock(mutex_);
  return addresses_.size();
}

// All of them when that does not make enough room: what they owe is then forgiven, but the memory
// stays bounded.
void ConnectionLimits::ForgetQuietAddresses(double now) {
  const auto most = kAddressesPerConnection * static_cast<std::size_t>(max_connections_);
  if (addresses_.size() < most) return;
  std::erase_if(addresses_, [now](const auto& entry) {
    return entry.second.open == 0 && entry.second.resets.IsFull(now);
  });
  if (addresses_.size() < most) return;
  std::erase_if(addresses_, [](const auto& entry) { return entry.second.open == 0; });
}

ConnectionLimits::Place::~Place() {
  const MutexLock lock(limits_.mutex_);
  --limits_.open_;
  if (!network_.empty()) --limits_.addresses_[network_].open;
}

absl::Status ConnectionLimits::Place::Charge(const std::string& network, double now) {
  const MutexLock lock(limits_.mutex_);
  limits_.ForgetQuietAddresses(now);
  Address& address = limits_.addresses_[network];
  if (address.open >= limits_.max_per_address_) {
    return absl::ResourceExhaustedError(
        absl::StrCat(network, " has ", limits_.max_per_address_, " connections already"));
  }
  ++address.open;
  network_ = network;
  return absl::OkStatus();
}

double ConnectionLimits::Place::TakeReset(double now) {
  if (network_.empty()) return now;
  const MutexLock lock(limits_.mutex_);
  return limits_.addresses_[network_].resets.Take(now);
}

}  // namespace ccst::server
