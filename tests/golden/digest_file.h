#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"

namespace ccst::golden {

/// Digests of samples by the names of their requests, and the revision of the algorithm that they
/// belong to.
struct DigestFile {
  int revision = 0;
  std::map<std::string, std::string> digests;
};

/// Reads lines of `algorithm_revision N` and `NAME DIGEST`; lines that begin with # are comments.
/// @errors INVALID_ARGUMENT a line that is neither, a name that comes twice, no revision.
absl::StatusOr<DigestFile> ParseDigestFile(const std::string& text);

/// The reverse; its first line says how the file is made.
std::string FormatDigestFile(const DigestFile& file);

/// Says why `now` may not take the place of `recorded`: the digest of a name that both have is
/// another one though the revision is the same, or the revision has been lowered. Empty when it
/// may.
std::string FindSilentChange(const DigestFile& recorded, const DigestFile& now);

}  // namespace ccst::golden
