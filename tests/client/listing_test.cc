#include "client/cli/listing.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ccst::cli {
namespace {

using ::testing::HasSubstr;

// Ends a line, clears the screen, sets a title, and turns the direction of writing.
constexpr char kHostile[] =
    "a\nb\x1b[2J\x1b]0;t\x07\xc2\x9b"
    "1m\xe2\x80\xae";

v1::Job HostileJob() {
  v1::Job job;
  job.set_name(std::string("jobs/") + kHostile);
  job.set_display_name(kHostile);
  job.set_mesh(kHostile);
  job.set_state(v1::Job::STATE_FAILED);
  job.mutable_error()->set_message(kHostile);
  job.mutable_result()->mutable_samples_digest()->set_sha256(kHostile);
  (*job.mutable_labels())[kHostile] = kHostile;
  return job;
}

v1::Mesh HostileMesh() {
  v1::Mesh mesh;
  mesh.set_name(kHostile);
  mesh.set_display_name(kHostile);
  mesh.add_warnings(kHostile);
  mesh.add_attributes()->set_attribute_name(kHostile);
  return mesh;
}

// Lines of `text`; expects it to hold nothing else that a terminal obeys.
std::ptrdiff_t Lines(const std::string& text) {
  for (const char* obeyed : {"\x1b", "\x07", "\xc2\x9b", "\xe2\x80\xae"}) {
    EXPECT_EQ(text.find(obeyed), std::string::npos);
  }
  return std::count(text.begin(), text.end(), '\n');
}

TEST(Listing, TablesKeepNamesOfOthersOnTheirLines) {
  EXPECT_EQ(Lines(JobsText({HostileJob(), HostileJob()})), 3);
  EXPECT_EQ(Lines(MeshesText({HostileMesh()})), 2);
  EXPECT_THAT(JobsText({HostileJob()}), HasSubstr("a\\nb\\u001b[2J"));
}

TEST(Listing, JsonSaysTheSameWithoutControlCharacters) {
  const std::string jobs = JobsJson({HostileJob()});
  Lines(jobs);
  EXPECT_EQ(nlohmann::json::parse(jobs).at(0).at("display_name"), kHostile);
  EXPECT_EQ(nlohmann::json::parse(jobs).at(0).at("labels").at(kHostile), kHostile);
  const std::string meshes = MeshesJson({HostileMesh()});
  Lines(meshes);
  EXPECT_EQ(nlohmann::json::parse(meshes).at(0).at("attributes").at(0), kHostile);
}

TEST(Listing, TimesThatAreNoneAreShownAsSuch) {
  v1::Job job;
  for (const std::int64_t seconds :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    job.mutable_create_time()->set_seconds(seconds);
    job.mutable_create_time()->set_nanos(-5);
    EXPECT_EQ(Lines(JobsText({job})), 2);
    EXPECT_TRUE(nlohmann::json::parse(JobsJson({job})).at(0).contains("create_time"));
  }
}

TEST(Listing, LongNamesDoNotWidenTheTableWithoutEnd) {
  v1::Job job;
  job.set_display_name(std::string(1 << 20, 'x'));
  EXPECT_LT(JobsText({job, v1::Job()}).size(), 4096u);
}

TEST(Listing, NamesInOtherScriptsStay) {
  v1::Job job;
  job.set_display_name("Prüfkörper 網格");
  EXPECT_THAT(JobsText({job}), HasSubstr("Prüfkörper 網格"));
  EXPECT_THAT(JobsJson({job}), HasSubstr("Prüfkörper 網格"));
}

}  // namespace
}  // namespace ccst::cli
