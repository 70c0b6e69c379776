#pragma once

#include <string>
#include <string_view>

namespace ccst::server {

/// What a caller may do; each includes the one before.
enum class Scope {
  kReadOnly,  ///< Look: server info, own jobs and meshes.
  kFull,      ///< Also compute, upload, cancel.
};

/// Who calls.
struct Caller {
  std::string owner;  ///< Printable ASCII without spaces, at most 128 bytes.
  Scope scope = Scope::kFull;
  bool known = false;      ///< By a token or a certificate; otherwise `owner` is only the address.
  std::string label = {};  ///< As logs call it; empty: `owner`. Nothing is decided by it.

  /// A word for a log line.
  const std::string& shown() const { return label.empty() ? owner : label; }

  /// Whose jobs and meshes the caller sees: its own, or, where callers are not known, everybody's.
  std::string visible_owner() const { return known ? owner : std::string(); }
};

/// `name` as a word of a log line: what cannot stand there becomes `_`, `unknown` stands for an
/// empty one, and 128 bytes are kept. Different names may become one.
std::string Printable(std::string_view name);

}  // namespace ccst::server
