#include "server/net/gate.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "server/net/descriptor_limit.h"
#include "server/net/self_check.h"
#include "tests/server/net/gate_fixture.h"

namespace ccst::server {
namespace {

class GateTest : public GateFixture {
 protected:
  // True when the connection is served.
  static bool IsServed(TestCaller& caller) {
    return caller.Send(kRequest) && caller.Receive(kRequest.size()) == kRequest;
  }
  bool WasCounted(const std::string& reason) {
    const auto all = counted();
    return std::find(all.begin(), all.end(), reason) != all.end();
  }
};

std::string RandomBytes(std::size_t count) {
  std::mt19937 random(5);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

// Frames of DATA, as a long upload has them.
std::string Upload(std::size_t frames) {
  const std::string payload = RandomBytes(16384);
  std::string bytes;
  for (std::size_t i = 0; i < frames; ++i) bytes += MakeData(1, payload);
  return bytes;
}

TEST_F(GateTest, BytesPassUnchangedBothWays) {
  for (const bool with_tls : {false, true}) {
    if (with_tls) UseTls(false);
    Start(Echo);
    TestCaller caller = Connect();
    if (with_tls) {
      ASSERT_TRUE(caller.StartTls());
    }
    const std::string bytes = kRequest + Upload(400);
    std::thread sender([&] { EXPECT_TRUE(caller.Send(bytes)); });
    // OpenSSL's sessions are not for two threads.
    if (with_tls) {
      sender.join();
      continue;
    }
    EXPECT_EQ(caller.Receive(bytes.size()), bytes);
    sender.join();
    gate_.reset();
  }
}

TEST_F(GateTest, LongAnswersOverTlsArriveWhole) {
  UseTls(false);
  const std::string answer = RandomBytes(5'000'000);
  Start([&answer](int socket) { send(socket, answer.data(), answer.size(), MSG_NOSIGNAL); });
  TestCaller caller = Connect();
  ASSERT_TRUE(caller.StartTls() && caller.Send(kRequest));
  EXPECT_EQ(caller.Receive(answer.size()), answer);
  EXPECT_TRUE(caller.SeesTheEnd());
}

TEST_F(GateTest, CallerIsFoundByTheNameOfItsSocketWhileItIsThere) {
  Start(Echo);
  TestCaller caller = Connect();
  ASSERT_TRUE(IsServed(caller));
  ASSERT_EQ(peers_seen().size(), 1U);
  EXPECT_EQ(peers_seen()[0].address, "127.0.0.1");
  EXPECT_FALSE(peers_seen()[0].certificate.has_value());
  EXPECT_FALSE(peers_seen()[0].vouched_by_proxy);
}

TEST_F(GateTest, WhatTheServiceSaidLastArrivesBeforeTheEnd) {
  Start([](int socket) {
    char byte = 0;
    recv(socket, &byte, 1, 0);
    send(socket, "goodbye", 7, MSG_NOSIGNAL);
  });
  TestCaller caller = Connect();
  ASSERT_TRUE(caller.Send(kRequest + Upload(1)));
  EXPECT_EQ(caller.Receive(100), "goodbye");
}

TEST_F(GateTest, EndOfTheCallerReachesTheService) {
  Start(Echo);
  TestCaller caller = Connect();
  ASSERT_TRUE(IsServed(caller));
  caller.HalfClose();
  EXPECT_TRUE(caller.SeesTheEnd());
  EXPECT_TRUE(Eventually([this] { return gate_->open() == 0; }));
}

TEST_F(GateTest, ConnectionsBeyondTheLimitEndAtOnceAndPlacesComeBack) {
  options_.max_connections = 3;
  options_.max_connections_per_address = 3;
  Start(Echo);
  std::vector<TestCaller> callers;
  for (int i = 0; i < 3; ++i) {
    callers.push_back(Connect());
    ASSERT_TRUE(IsServed(callers.back()));
  }
  TestCaller fourth = Connect();
  EXPECT_TRUE(fourth.SeesTheEnd());
  EXPECT_TRUE(WasCounted("all"));
  callers.clear();
  ASSERT_TRUE(Eventually([this] { return gate_->open() == 0; }));
  TestCaller next = Connect();
  EXPECT_TRUE(IsServed(next));
}

std::string ProxyHeader(char last_number, char command = 0x21) {
  std::string header("\r\n\r\n\0\r\nQUIT\n", 12);
  header += command;
  header += std::string("\x11\0\x0c\x0a\0\0", 6);
  header += last_number;
  return header + std::string("\x7f\0\0\1\x12\x34\x12\x34", 8);
}

TEST_F(GateTest, OneAddressCannotTakeThePlacesOfOthers) {
  options_.max_connections_per_address = 2;
  Start(Echo);
  std::vector<TestCaller> callers;
  for (int i = 0; i < 2; ++i) {
    callers.push_back(ConnectToProxySocket());
    ASSERT_TRUE(callers.back().Send(ProxyHeader(1)));
    ASSERT_TRUE(IsServed(callers.back()));
  }
  TestCaller third = ConnectToProxySocket();
  third.Send(ProxyHeader(1));
  EXPECT_TRUE(third.SeesTheEnd());
  EXPECT_TRUE(WasCounted("address"));
  TestCaller other = ConnectToProxySocket();
  ASSERT_TRUE(other.Send(ProxyHeader(2)));
  EXPECT_TRUE(IsServed(other));
  EXPECT_EQ(peers_seen().back().address, "10.0.0.2");
  EXPECT_TRUE(peers_seen().back().vouched_by_proxy);
}

TEST_F(GateTest, ProxyHeaderMayComeInPiecesAndBeforeTls) {
  UseTls(false);
  Start(Echo);
  TestCaller caller = ConnectToProxySocket();
  for (const char byte : ProxyHeader(7)) ASSERT_TRUE(caller.Send(std::string(1, byte)));
  ASSERT_TRUE(caller.StartTls());
  EXPECT_TRUE(IsServed(caller));
  EXPECT_EQ(peers_seen().back().address, "10.0.0.7");
  // It saw the handshake itself: no proxy has a say in whose certificate it was.
  EXPECT_FALSE(peers_seen().back().vouched_by_proxy);
}

TEST_F(GateTest, ConnectionWithoutHeaderAtTheProxySocketIsOfThisMachine) {
  Start(Echo);
  TestCaller caller = ConnectToProxySocket();
  EXPECT_TRUE(IsServed(caller));
  EXPECT_EQ(peers_seen().back().address, "unix");
}

TEST_F(GateTest, BrokenProxyHeaderEndsTheConnection) {
  Start(Echo);
  TestCaller caller = ConnectToProxySocket();
  caller.Send(ProxyHeader(1, 0x22));
  EXPECT_TRUE(caller.SeesTheEnd());
  EXPECT_TRUE(WasCounted("proxy"));
}

TEST_F(GateTest, WhatIsNotHttp2DoesNotReachTheService) {
  Start(Echo);
  for (const std::string wrong :
       {"", "hello", "PRI * HTTP/2.0\r\n\r\nSM", "GET / HTTP/1.1\r\n\r\n"}) {
    TestCaller caller = Connect();
    ASSERT_TRUE(caller.Send(wrong));
    caller.HalfClose();
    EXPECT_TRUE(caller.SeesTheEnd()) << wrong;
  }
  EXPECT_TRUE(peers_seen().empty());
  TestCaller right = Connect();
  for (const char byte : kRequest) ASSERT_TRUE(right.Send(std::string(1, byte)));
  EXPECT_EQ(right.Receive(kRequest.size()), kRequest);
}

TEST_F(GateTest, MayEndWhileItsThreadsBegin) {
  // The first task of each is under way or yet to come.
  GateOptions options;
  options.listen = "127.0.0.1:0";
  for (int i = 0; i < 300; ++i) {
    Peers peers;
    auto gate = ConnectionGate::Open(options, {.peers = peers,
                                               .hand_over = [](int) { return false; },
                                               .count = [](std::string_view) {},
                                               .report = [](const std::string&) {}});
    ASSERT_TRUE(gate.ok()) << gate.status();
  }
}

TEST_F(GateTest, OnThePortNobodyMaySpeakForOthers) {
  Start(Echo);
  TestCaller caller = Connect();
  caller.Send(ProxyHeader(1) + kRequest);
  EXPECT_TRUE(caller.SeesTheEnd());
  EXPECT_TRUE(WasCounted("protocol"));
  EXPECT_TRUE(peers_seen().empty());
}

TEST_F(GateTest, CertificateSaysWhoTheCallerIs) {
  UseTls(true);
  Start(Echo);
  const TestCertificate own =
      MakeCertificateOf(authority_, {.subject = {{.type = "CN", .value = "alice"}}});
  TestCaller caller = Connect();
  ASSERT_TRUE(caller.StartTls(&own));
  ASSERT_TRUE(IsServed(caller));
  ASSERT_TRUE(peers_seen().back().certificate.has_value());
  EXPECT_EQ((*peers_seen().back().certificate)->owner, "alice");
}

TEST_F(GateTest, NoCertificateAndOneOfAnotherAuthorityAreRefused) {
  UseTls(true);
  Start(Echo);
  const TestCertificate stranger = MakeCertificate(MakeAuthority("other"), "stranger");
  for (const TestCertificate* own : {static_cast<const TestCertificate*>(nullptr), &stranger}) {
    TestCaller caller = Connect();
    // In TLS 1.3 the client learns it after its own part of the handshake.
    if (caller.StartTls(own)) {
      EXPECT_FALSE(IsServed(caller));
    }
  }
  EXPECT_TRUE(Eventually([this] { return counted().size() == 2; }));
  EXPECT_TRUE(WasCounted("handshake"));
  ASSERT_EQ(lines().size(), 1U);
  EXPECT_NE(lines()[0].find("did not return a certificate"), std::string::npos) << lines()[0];
  EXPECT_TRUE(peers_seen().empty());
}

TEST_F(GateTest, SilentConnectionsGiveTheirPlacesBack) {
  options_.patience = {.begin = 0.05, .request = 0.05, .unread = 60.0, .farewell = 0.05};
  options_.arrival_seconds = 0.05;
  Start(Echo);
  TestCaller silent = Connect();
  EXPECT_TRUE(silent.SeesTheEnd());
  TestCaller no_request = Connect();
  ASSERT_TRUE(no_request.Send(kHttp2Preface + MakeSettings()));
  no_request.Receive((kHttp2Preface + MakeSettings()).size());
  EXPECT_TRUE(no_request.SeesTheEnd());
  TestCaller half_a_header = ConnectToProxySocket();
  ASSERT_TRUE(half_a_header.Send("\r\n\r"));
  EXPECT_TRUE(half_a_header.SeesTheEnd());
  EXPECT_TRUE(WasCounted("silent"));
  EXPECT_TRUE(Eventually([this] { return gate_->open() == 0; }));
}

TEST_F(GateTest, SlowHandshakeEndsInTime) {
  UseTls(false);
  options_.arrival_seconds = 0.05;
  Start(Echo);
  TestCaller caller = Connect();
  ASSERT_TRUE(caller.Send("\x16\x03\x01"));
  EXPECT_TRUE(caller.SeesTheEnd());
  EXPECT_TRUE(WasCounted("silent"));
}

TEST_F(GateTest, WhoDoesNotReadLosesTheConnection) {
  options_.patience.unread = 0.2;
  Start([](int socket) {
    const std::string much(1 << 20, 'a');
    while (send(socket, much.data(), much.size(), MSG_NOSIGNAL) > 0) {
    }
  });
  TestCaller caller = Connect();
  ASSERT_TRUE(caller.Send(kRequest));
  EXPECT_TRUE(Eventually([this] { return WasCounted("unread"); }));
  EXPECT_TRUE(Eventually([this] { return gate_->open() == 0; }));
}

TEST_F(GateTest, EndlessBlockOfHeadersEndsTheConnection) {
  Start(Echo);
  TestCaller caller = Connect();
  ASSERT_TRUE(caller.Send(kHttp2Preface + MakeSettings() + MakeHeaders(1, "h", false)));
  while (caller.Send(MakeContinuation(1, std::string(1000, 'h')))) {
  }
  EXPECT_TRUE(Eventually([this] { return WasCounted("protocol"); }));
}

TEST_F(GateTest, WithoutDescriptorsConnectionsAreTurnedAwayAndThenServedAgain) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's own checks need descriptors";
#endif
  Start(Echo);
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  // The caller's own end is there before all numbers below the limit are taken.
  FileDescriptor own_end = NewSocket();
  const rlimit few = {.rlim_cur = static_cast<rlim_t>(own_end.get()) + 64,
                      .rlim_max = before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<FileDescriptor> taken;
  do {
    taken.emplace_back(dup(0));
  } while (taken.back().is_open());
  TestCaller refused = Connect(std::move(own_end));
  EXPECT_TRUE(refused.SeesTheEnd());
  EXPECT_TRUE(Eventually([this] { return WasCounted("descriptors"); }));
  taken.clear();
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  TestCaller next = Connect();
  EXPECT_TRUE(IsServed(next));
}

TEST_F(GateTest, ClosedGateTakesNobody) {
  Start(Echo);
  TestCaller caller = Connect();
  ASSERT_TRUE(IsServed(caller));
  gate_->Close();
  EXPECT_TRUE(IsServed(caller));  // Who is there stays.
  EXPECT_EQ(peers_seen().size(), 1U);
}

// Answers with the head of a response, as gRPC would.
void Answer(int socket) {
  char room[1024];
  if (recv(socket, room, sizeof room, 0) <= 0) return;
  const std::string answer = MakeSettings() + MakeHeaders(1, "status");
  send(socket, answer.data(), answer.size(), MSG_NOSIGNAL);
  ReadToTheEnd(socket);
}

TEST_F(GateTest, ReachesItselfWhenOthersHaveAllPlaces) {
  options_.max_connections = 1;
  Start(Answer);
  TestCaller other = Connect();
  ASSERT_TRUE(other.Send(kRequest));
  ASSERT_FALSE(other.Receive(1).empty());
  EXPECT_TRUE(ReachOneself(*gate_, 20.0).ok());
}

TEST_F(GateTest, ReachesItselfOverTlsWithoutACertificateForIt) {
  UseTls(true);
  Start(Answer);
  const absl::Status status = ReachOneself(*gate_, 20.0);
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_TRUE(counted().empty());
}

TEST_F(GateTest, DoesNotReachItselfWhenNobodyAnswers) {
  Start(ReadToTheEnd);
  EXPECT_TRUE(absl::IsUnavailable(ReachOneself(*gate_, 0.1)));
  gate_->Close();
  EXPECT_TRUE(absl::IsUnavailable(ReachOneself(*gate_, 0.1)));
}

TEST(SelfCheck, TellsOnceAfterSoManyFailuresInARow) {
  std::atomic<int> looks = 0;
  std::promise<std::string> told;
  {
    const SelfCheck check(
        {.interval_seconds = 0.001, .patience_seconds = 7.0, .failures = 3},
        [&looks](double seconds) {
          EXPECT_EQ(seconds, 7.0);
          // A success in between: it begins to count anew.
          return ++looks == 3 ? absl::OkStatus() : absl::UnavailableError("nobody is there");
        },
        [&told](const std::string& reason) { told.set_value(reason); });
    EXPECT_EQ(told.get_future().get(), "nobody is there");
  }
  EXPECT_EQ(looks, 6);
}

TEST(RaiseDescriptorLimit, SoftLimitBecomesTheHardOne) {
  rlimit before = {};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit low = {.rlim_cur = 64, .rlim_max = before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
  EXPECT_EQ(DescriptorLimit(), 64);
  EXPECT_EQ(RaiseDescriptorLimit(), static_cast<std::int64_t>(before.rlim_max));
  EXPECT_EQ(DescriptorLimit(), static_cast<std::int64_t>(before.rlim_max));
}

}  // namespace
}  // namespace ccst::server
