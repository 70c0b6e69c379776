#pragma once

#include <string>

namespace ccst::server {

/// A certificate and its private key, as PEM.
struct TestCertificate {
  std::string certificate;
  std::string key;
};

/// One that vouches for others, by itself. Valid for an hour, like the others.
TestCertificate MakeAuthority(const std::string& name);

/// One that `authority` vouches for: for `localhost` and 127.0.0.1 as a server, for `name` as a
/// client.
TestCertificate MakeCertificate(const TestCertificate& authority, const std::string& name);

}  // namespace ccst::server
