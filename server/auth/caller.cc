#include "server/auth/caller.h"

#include "absl/strings/ascii.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxOwnerBytes = 128;

}  // namespace

std::string Printable(std::string_view name) {
  std::string word(name.substr(0, kMaxOwnerBytes));
  for (char& c : word) {
    if (!absl::ascii_isgraph(static_cast<unsigned char>(c))) c = '_';
  }
  return word.empty() ? "unknown" : word;
}

}  // namespace ccst::server
