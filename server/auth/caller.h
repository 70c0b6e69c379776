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
  bool known = false;  ///< By a token or a certificate; otherwise `owner` is only what the
                       ///< connection is called.

  /// Whose jobs and meshes the caller sees: its own, or, where callers are not known, everybody's.
  std::string visible_owner() const { return known ? owner : std::string(); }
};

/// `name` as an owner: what cannot stand in a word of a log line, as in names of certificates,
/// becomes `_`; `unknown` for an empty one.
std::string Printable(std::string_view name);

}  // namespace ccst::server
