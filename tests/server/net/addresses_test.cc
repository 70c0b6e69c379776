// Machines' addresses, what a proxy says of them, and listening at them.
#include <cstring>
#include <fstream>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "server/net/listener.h"
#include "server/net/machine_address.h"
#include "server/net/proxy_header.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {
namespace {

MachineAddress Parsed(int family, const char* text) {
  in6_addr bytes = {};
  EXPECT_EQ(inet_pton(family, text, &bytes), 1) << text;
  return family == AF_INET ? MachineAddressOfIpv4(&bytes, 7) : MachineAddressOfIpv6(&bytes, 7);
}

TEST(MachineAddress, IsWrittenAsInAddresses) {
  EXPECT_EQ(Parsed(AF_INET, "10.0.0.1").text, "10.0.0.1");
  EXPECT_EQ(Parsed(AF_INET6, "2001:db8::1").text, "[2001:db8::1]");
  EXPECT_EQ(Parsed(AF_INET6, "::ffff:10.0.0.1").text, "10.0.0.1");
  EXPECT_EQ(MachineAddressOf({}).text, "unix");
}

TEST(MachineAddress, NetworkOfIpv6IsOneForLimits) {
  const std::string network = Parsed(AF_INET6, "2001:db8:1:2::1").network;
  EXPECT_EQ(Parsed(AF_INET6, "2001:db8:1:2:ffff::9").network, network);
  EXPECT_NE(Parsed(AF_INET6, "2001:db8:1:3::1").network, network);
  EXPECT_NE(Parsed(AF_INET, "10.0.0.1").network, Parsed(AF_INET, "10.0.0.2").network);
  EXPECT_EQ(Parsed(AF_INET6, "::ffff:10.0.0.1").network, Parsed(AF_INET, "10.0.0.1").network);
}

// As HAProxy 2.6 sends it; section 2.2 of the protocol.
std::string Header(int command, int family, const std::string& rest) {
  std::string header("\r\n\r\n\0\r\nQUIT\n", 12);
  header += static_cast<char>(command);
  header += static_cast<char>(family);
  header += static_cast<char>(rest.size() >> 8);
  header += static_cast<char>(rest.size() & 0xff);
  return header + rest;
}

const std::string kIpv4 = std::string("\x0a\x01\x02\x03\x7f\x00\x00\x01\x12\x34\xc3\x83", 12);
const std::string kIpv6 = std::string("\x20\x01\x0d\xb8\0\0\0\0\0\0\0\0\0\0\0\x05", 16) +
                          std::string(16, '\1') + std::string("\x12\x34\xc3\x83", 4);

TEST(ProxyHeader, SourceIsTheCallersAddress) {
  EXPECT_EQ(ParseProxyHeader(Header(0x21, 0x11, kIpv4))->text, "10.1.2.3");
  EXPECT_EQ(ParseProxyHeader(Header(0x21, 0x11, kIpv4))->port, 0x1234);
  EXPECT_EQ(ParseProxyHeader(Header(0x21, 0x21, kIpv6))->text, "[2001:db8::5]");
  EXPECT_EQ(ParseProxyHeader(Header(0x21, 0x11, kIpv4 + "\x04\0\1x"))->text, "10.1.2.3");
}

TEST(ProxyHeader, WhatTheProxyAsksForItselfComesFromThisMachine) {
  EXPECT_EQ(ParseProxyHeader(Header(0x20, 0x00, ""))->text, "unix");
  EXPECT_EQ(ParseProxyHeader(Header(0x20, 0x11, kIpv4))->text, "unix");
}

TEST(ProxyHeader, BrokenOnesAreRefused) {
  const std::string right = Header(0x21, 0x11, kIpv4);
  for (std::size_t size = 0; size < right.size(); ++size) {
    EXPECT_FALSE(ParseProxyHeader(right.substr(0, size)).ok()) << size;
  }
  for (std::size_t at = 0; at < 12; ++at) {
    std::string wrong = right;
    wrong[at] ^= 1;
    EXPECT_FALSE(ParseProxyHeader(wrong).ok()) << at;
  }
  for (const std::string& wrong :
       {Header(0x22, 0x11, kIpv4), Header(0x11, 0x11, kIpv4), Header(0x21, 0x00, ""),
        Header(0x21, 0x31, std::string(216, 'p')), Header(0x21, 0x12, kIpv4),
        Header(0x21, 0x21, kIpv4), Header(0x21, 0x11, std::string(11, '1')), right + "x"}) {
    EXPECT_FALSE(ParseProxyHeader(wrong).ok());
  }
  EXPECT_FALSE(ProxyHeaderRest(Header(0x21, 0x11, std::string(2049, 't'))).ok());
  EXPECT_TRUE(ProxyHeaderRest(Header(0x21, 0x11, std::string(2048, 't'))).ok());
}

bool CanConnect(const std::string& host_port) {
  const std::size_t colon = host_port.rfind(':');
  sockaddr_in ipv4 = {};
  ipv4.sin_family = AF_INET;
  ipv4.sin_port = htons(static_cast<std::uint16_t>(std::stoi(host_port.substr(colon + 1))));
  inet_pton(AF_INET, "127.0.0.1", &ipv4.sin_addr);
  const FileDescriptor socket(::socket(AF_INET, SOCK_STREAM, 0));
  return connect(socket.get(), reinterpret_cast<sockaddr*>(&ipv4), sizeof ipv4) == 0;
}

TEST(ListenAt, FreePortIsPickedAndTold) {
  const auto listener = ListenAt("127.0.0.1:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  EXPECT_EQ(listener->address.rfind("127.0.0.1:", 0), 0U);
  EXPECT_NE(listener->address, "127.0.0.1:0");
  EXPECT_TRUE(CanConnect(listener->address));
}

TEST(ListenAt, NameIsListenedAtOnOnePort) {
  const auto listener = ListenAt("localhost:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  EXPECT_EQ(listener->address.rfind("localhost:", 0), 0U);
  EXPECT_TRUE(CanConnect(listener->address));
}

TEST(ListenAt, EveryIpv6AddressIsEveryIpv4AddressToo) {
  const auto listener = ListenAt("[::]:0");
  if (!listener.ok()) GTEST_SKIP() << "this machine has no IPv6";
  EXPECT_TRUE(CanConnect(listener->address));
}

TEST(ListenAt, PlaceThatIsTakenOrNotThereIsRefusedInWords) {
  const auto first = ListenAt("127.0.0.1:0");
  ASSERT_TRUE(first.ok());
  for (const std::string& place :
       {first->address, std::string("192.0.2.1:0"), std::string("nobody.invalid:0")}) {
    const auto second = ListenAt(place);
    EXPECT_TRUE(absl::IsUnavailable(second.status()));
    EXPECT_NE(second.status().message().find("cannot listen on " + place), std::string::npos);
  }
}

bool CanConnectTo(const std::string& path) {
  sockaddr_un place = {};
  place.sun_family = AF_UNIX;
  std::strncpy(place.sun_path, path.c_str(), sizeof place.sun_path - 1);
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  return connect(socket.get(), reinterpret_cast<sockaddr*>(&place), sizeof place) == 0;
}

TEST(ListenAtPath, GroupMayConnectAndOthersMayNot) {
  const TempFolder folder;
  const std::string path = folder.Path("proxy.sock");
  const auto listener = ListenAtPath(path);
  ASSERT_TRUE(listener.ok()) << listener.status();
  EXPECT_TRUE(CanConnectTo(path));
  struct stat info = {};
  ASSERT_EQ(stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0660U);
}

TEST(ListenAtPath, SocketThatIsLeftOverIsReplacedAndOneInUseIsNot) {
  const TempFolder folder;
  const std::string path = folder.Path("proxy.sock");
  { ASSERT_TRUE(ListenAtPath(path).ok()); }
  const auto second = ListenAtPath(path);
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_TRUE(absl::IsUnavailable(ListenAtPath(path).status()));
  EXPECT_TRUE(CanConnectTo(path));
}

TEST(ListenAtPath, FileOfAnotherKindAndALongPathAreLeftAlone) {
  TempFolder folder;
  const std::string path = folder.Write("notes", "precious");
  EXPECT_TRUE(absl::IsUnavailable(ListenAtPath(path).status()));
  std::ifstream file(path);
  std::string text;
  file >> text;
  EXPECT_EQ(text, "precious");
  EXPECT_TRUE(absl::IsUnavailable(ListenAtPath("/tmp/" + std::string(200, 'x')).status()));
}

}  // namespace
}  // namespace ccst::server
