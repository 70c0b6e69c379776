#include "server/auth/token.h"

#include <algorithm>
#include <optional>
#include <set>

#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr char kTokenPrefix[] = "ccst_";
constexpr std::size_t kMaxNameBytes = 64;
constexpr char kFullName[] = "full";
constexpr char kReadOnlyName[] = "read-only";

std::string ToHex(const TokenHash& bytes) {
  return absl::BytesToHexString(
      absl::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::optional<TokenHash> HashFromHex(absl::string_view text) {
  TokenHash hash;
  const bool is_hex = std::all_of(text.begin(), text.end(), absl::ascii_isxdigit);
  if (!is_hex || text.size() != 2 * hash.size()) return std::nullopt;
  const std::string bytes = absl::HexStringToBytes(text);
  std::copy(bytes.begin(), bytes.end(), hash.begin());
  return hash;
}

absl::Status LineError(int line, std::string_view message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                   absl::StrCat("line ", line, ": ", std::string(message),
                                "; right is NAME read-only|full SHA256, as --new-token prints"));
}

}  // namespace

TokenHash HashToken(std::string_view token) {
  TokenHash hash;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), hash.data());
  return hash;
}

absl::StatusOr<std::string> NewToken() {
  TokenHash random;
  if (RAND_bytes(random.data(), static_cast<int>(random.size())) != 1) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                     "the system gave no random bytes");
  }
  return absl::StrCat(kTokenPrefix, ToHex(random));
}

std::string TokenLine(std::string_view name, Scope scope, std::string_view token) {
  return absl::StrCat(std::string(name), " ", scope == Scope::kFull ? kFullName : kReadOnlyName,
                      " ", ToHex(HashToken(token)));
}

bool IsTokenName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxNameBytes &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
                  std::string_view("._@-").find(c) != std::string_view::npos;
         });
}

absl::StatusOr<std::vector<TokenEntry>> ParseTokens(std::string_view text) {
  std::vector<TokenEntry> entries;
  std::set<TokenHash> seen;
  int number = 0;
  for (const absl::string_view line :
       absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
    ++number;
    const absl::string_view content = absl::StripAsciiWhitespace(line);
    if (content.empty() || content.front() == '#') continue;
    const std::vector<std::string> words =
        absl::StrSplit(content, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    if (words.size() != 3) return LineError(number, "has not three words");
    if (!IsTokenName(words[0])) return LineError(number, "the name is not of letters and ._@-");
    const bool is_full = words[1] == kFullName;
    if (!is_full && words[1] != kReadOnlyName) return LineError(number, "the scope is unknown");
    const auto hash = HashFromHex(words[2]);
    if (!hash.has_value()) return LineError(number, "the hash is not of 64 hexadecimal digits");
    if (!seen.insert(*hash).second) return LineError(number, "the token is there twice");
    entries.push_back({.caller = {.owner = words[0],
                                  .scope = is_full ? Scope::kFull : Scope::kReadOnly,
                                  .known = true},
                       .hash = *hash});
  }
  return entries;
}

const Caller* FindCaller(const std::vector<TokenEntry>& entries, std::string_view token) {
  const TokenHash hash = HashToken(token);
  const Caller* found = nullptr;
  for (const TokenEntry& entry : entries) {
    if (CRYPTO_memcmp(entry.hash.data(), hash.data(), hash.size()) == 0) found = &entry.caller;
  }
  return found;
}

}  // namespace ccst::server
