#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace ccst::server {

/// Whom a certificate names.
struct CertificateIdentity {
  /// Differs where the names differ: printable ASCII without spaces, at most 128 bytes.
  std::string owner;
  /// For people: what can be printed of the name, and where that is not all of it the beginning of
  /// a digest. Like `owner` fit for a word of a log line, but nothing may be decided by it.
  std::string label;
};

/// The identity of a certificate's holder: the whole subject, attribute by attribute in its order,
/// together with all alternative names in any order. A renewed certificate with the same names has
/// the same identity, whatever its key, dates and kinds of strings.
///
/// A certificate that names nothing but a common name of printable ASCII has that for its owner;
/// every other has `x509:` and a SHA-256 of its names.
///
/// @param der  the certificate as DER; whoever vouches for it was asked before.
/// @errors UNAUTHENTICATED  the certificate is broken or names nobody
absl::StatusOr<CertificateIdentity> IdentifyCertificate(std::string_view der);

}  // namespace ccst::server
