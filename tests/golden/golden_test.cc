#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/sampling/algorithm_revision.h"
#include "tests/golden/digest_file.h"
#include "tests/golden/requests.h"

namespace ccst::golden {
namespace {

DigestFile Recorded() {
  std::ifstream in(CCST_SOURCE_DIR "/tests/golden/digests.txt");
  std::stringstream text;
  text << in.rdbuf();
  absl::StatusOr<DigestFile> file = ParseDigestFile(text.str());
  EXPECT_TRUE(file.ok()) << file.status();
  return file.ok() ? *file : DigestFile{};
}

TEST(GoldenFile, IsOfThisRevision) {
  EXPECT_EQ(Recorded().revision, kAlgorithmRevision)
      << "record the digests of this revision: "
         "build/release/bin/ccst_golden tests/golden/digests.txt";
}

TEST(GoldenFile, HasEachRequestAndNoOther) {
  std::set<std::string> wanted;
  for (const Request& request : Requests()) {
    EXPECT_TRUE(wanted.insert(request.name).second) << request.name << " comes twice";
  }
  std::set<std::string> found;
  for (const auto& [name, digest] : Recorded().digests) {
    found.insert(name);
    EXPECT_EQ(digest.size(), 64U) << name << ": " << digest;
  }
  EXPECT_EQ(found, wanted);
}

std::vector<std::string> Names() {
  std::vector<std::string> names;
  for (const Request& request : Requests()) names.push_back(request.name);
  return names;
}

class Golden : public testing::TestWithParam<std::string> {};

TEST_P(Golden, SamplesAreThoseOfTheRevision) {
  DigestFile now;
  now.revision = kAlgorithmRevision;
  for (const Request& request : Requests()) {
    if (request.name == GetParam()) now.digests[request.name] = DigestOf(request);
  }
  ASSERT_EQ(now.digests.size(), 1U);
  EXPECT_EQ(FindSilentChange(Recorded(), now), "");
}

INSTANTIATE_TEST_SUITE_P(Requests, Golden, testing::ValuesIn(Names()), [](const auto& tested) {
  std::string name;
  for (const char c : tested.param) {
    if (c != '-') name += c;
  }
  return name;
});

}  // namespace
}  // namespace ccst::golden
