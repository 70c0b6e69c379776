#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "server/auth/caller.h"

namespace ccst::server {

using TokenHash = std::array<std::uint8_t, 32>;

/// A line of a token file: who may come with a token of this SHA-256.
struct TokenEntry {
  Caller caller;
  TokenHash hash;
};

/// SHA-256 of a token. Tokens are 256 random bits, so they need neither salt nor stretching.
TokenHash HashToken(std::string_view token);

/// A token nobody can guess: `ccst_` and 64 hexadecimal digits.
/// @errors INTERNAL  the machine has no randomness to give
absl::StatusOr<std::string> NewToken();

/// The line `name scope sha256` of a token file for `token`.
std::string TokenLine(std::string_view name, Scope scope, std::string_view token);

/// True for 1 to 64 letters, digits and `._@-`: what an owner in a token file may be called.
bool IsTokenName(std::string_view name);

/// Reads the text of a token file: one `name scope sha256` a line; empty lines and those that
/// begin with `#` mean nothing. A name may have several tokens.
/// @errors INVALID_ARGUMENT OPTION_INVALID naming the line, not what is in it
absl::StatusOr<std::vector<TokenEntry>> ParseTokens(std::string_view text);

/// The caller whose token it is; null for none. Takes as long whichever entry fits.
const Caller* FindCaller(const std::vector<TokenEntry>& entries, std::string_view token);

}  // namespace ccst::server
