#include "server/rpc/call.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/status.h"
#include "proto/convert/field_limits.h"
#include "server/rpc/grpc_status.h"

namespace ccst::server {
namespace {

constexpr std::string_view kPeerPrefix = "unix-abstract:";
// DER, from a proxy that has ended TLS; looked at only where such a proxy is trusted.
constexpr char kCertificateKey[] = "x-ccst-client-certificate-bin";

std::string_view Metadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto& metadata = context.client_metadata();
  const auto found = metadata.find(key);
  if (found == metadata.end()) return {};
  return {found->second.data(), found->second.size()};
}

// Callers over the network have local sockets whose names are those of Peers.
Peer PeerOf(const grpc::CallbackServerContext& context, const Peers& peers) {
  const std::string name = context.peer();
  const std::string_view known = std::string_view(name).substr(0, kPeerPrefix.size());
  if (known != kPeerPrefix) return {.address = name};  // Within the process.
  const auto found = peers.Find(std::string_view(name).substr(kPeerPrefix.size()));
  // A call that begins when its connection has gone is nobody's.
  if (found == nullptr) return {.address = "gone", .certificate = IdentifyCertificate("")};
  Peer peer = *found;
  const std::string_view certificate = Metadata(context, kCertificateKey);
  if (peer.vouched_by_proxy && !certificate.empty()) {
    peer.certificate = IdentifyCertificate(certificate);
  }
  return peer;
}

bool IsLowerHex(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool IsZero(std::string_view text) { return text.find_first_not_of('0') == std::string_view::npos; }

}  // namespace

std::string TraceId(std::string_view traceparent) {
  // 00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01; later versions may go on after a dash.
  constexpr std::size_t kLength = 55;
  constexpr std::array<std::size_t, 3> kDashes = {2, 35, 52};
  if (traceparent.size() < kLength) return {};
  for (const std::size_t at : kDashes) {
    if (traceparent[at] != '-') return {};
  }
  const std::string_view version = traceparent.substr(0, 2);
  const std::string_view trace = traceparent.substr(3, 32);
  const std::string_view parent = traceparent.substr(36, 16);
  const std::string_view flags = traceparent.substr(53, 2);
  if (!IsLowerHex(version) || !IsLowerHex(trace) || !IsLowerHex(parent) || !IsLowerHex(flags)) {
    return {};
  }
  const bool goes_on = traceparent.size() > kLength;
  if (version == "ff" || (goes_on && (version == "00" || traceparent[kLength] != '-'))) return {};
  if (IsZero(trace) || IsZero(parent)) return {};
  return std::string(trace);
}

Call::Call(const CallSupport& support, const grpc::CallbackServerContext& context,
           std::string_view method, Scope needed)
    : support_(support), start_seconds_(support.clock.seconds()) {
  const Peer peer = PeerOf(context, support.peers);
  auto caller = support_.authenticator.Authenticate(Metadata(context, "authorization"), peer);
  if (caller.ok()) {
    caller_ = *std::move(caller);
    admission_ = CheckScope(caller_, needed);
  } else {
    caller_ = {.owner = Printable(peer.address), .scope = Scope::kReadOnly};
    admission_ = caller.status();
  }
  record_.method = std::string(method);
  record_.owner = caller_.shown();
  record_.trace_id = TraceId(Metadata(context, "traceparent"));
  record_.code = absl::StatusCodeToString(absl::StatusCode::kUnknown);
}

Call::~Call() {
  record_.seconds = support_.clock.seconds() - start_seconds_;
  support_.metrics.CountRequest(record_.method, record_.code, record_.seconds,
                                record_.request_bytes, record_.response_bytes);
  support_.log.Request(record_);
}

absl::Status Call::Received(const google::protobuf::Message& message) {
  record_.request_bytes += static_cast<std::int64_t>(message.ByteSizeLong());
  return CheckFieldLimits(message);
}

void Call::Sent(const google::protobuf::Message& message) {
  record_.response_bytes += static_cast<std::int64_t>(message.ByteSizeLong());
  ++record_.messages_sent;
}

grpc::Status Call::End(const absl::Status& status) {
  record_.code = absl::StatusCodeToString(status.code());
  const auto reason = GetErrorReason(status);
  record_.reason = reason.has_value() ? std::string(ErrorReasonName(*reason)) : "";
  return ToGrpcStatus(status);
}

}  // namespace ccst::server
