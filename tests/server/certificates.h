#pragma once

#include <string>
#include <vector>

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

/// Its certificate as DER.
std::string DerOf(const TestCertificate& certificate);

/// One attribute of a subject.
struct TestAttribute {
  std::string type;   ///< As OpenSSL calls it, for example `CN`.
  std::string value;  ///< UTF-8; may hold any byte.
  /// One of OpenSSL's V_ASN1_ numbers, or 0 for UTF-8.
  int kind = 0;
  bool beside = false;  ///< In one set with the attribute before.

  auto operator<=>(const TestAttribute&) const = default;
};

/// What a certificate calls its holder.
struct TestNames {
  std::vector<TestAttribute> subject = {};
  std::string alternatives = {};  ///< As OpenSSL writes them: `DNS:a,URI:b`; empty: there are none.
};

/// One for a holder of these names alone.
TestCertificate MakeCertificateOf(const TestCertificate& authority, const TestNames& names);

}  // namespace ccst::server
