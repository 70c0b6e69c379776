#include "tests/golden/digest_file.h"

#include <sstream>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace ccst::golden {
namespace {

constexpr char kRevision[] = "algorithm_revision";

}  // namespace

absl::StatusOr<DigestFile> ParseDigestFile(const std::string& text) {
  DigestFile file;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    std::string name, value, more;
    if (!(words >> name >> value) || (words >> more)) {
      return absl::InvalidArgumentError(absl::StrCat("not a name and a value: ", line));
    }
    if (name == kRevision) {
      if (file.revision != 0 || !absl::SimpleAtoi(value, &file.revision)) {
        return absl::InvalidArgumentError(absl::StrCat("not the one revision: ", line));
      }
    } else if (!file.digests.emplace(name, value).second) {
      return absl::InvalidArgumentError(absl::StrCat(name, " comes twice"));
    }
  }
  if (file.revision == 0) return absl::InvalidArgumentError("there is no algorithm_revision");
  return file;
}

std::string FormatDigestFile(const DigestFile& file) {
  std::string text =
      absl::StrCat("# Made by: build/release/bin/ccst_golden tests/golden/digests.txt\n", kRevision,
                   " ", file.revision, "\n");
  for (const auto& [name, digest] : file.digests) absl::StrAppend(&text, name, " ", digest, "\n");
  return text;
}

std::string FindSilentChange(const DigestFile& recorded, const DigestFile& now) {
  if (now.revision < recorded.revision) {
    return absl::StrCat("kAlgorithmRevision went back from ", recorded.revision, " to ",
                        now.revision);
  }
  if (now.revision > recorded.revision) return "";
  for (const auto& [name, digest] : now.digests) {
    const auto before = recorded.digests.find(name);
    if (before == recorded.digests.end() || before->second == digest) continue;
    return absl::StrCat("the samples of '", name, "' have changed, from ", before->second, " to ",
                        digest, ", but kAlgorithmRevision is ", now.revision,
                        " as before. If the change is wanted, raise it "
                        "(core/docs/determinism.md), then record the digests anew");
  }
  return "";
}

}  // namespace ccst::golden
