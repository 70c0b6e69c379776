#include "tests/server/store/store_fixture.h"

#include <cstdlib>
#include <filesystem>
#include <utility>

#include "core/base/sha256.h"
#include "core/base/status.h"

namespace ccst::server {

namespace {

std::string FastFolder() {
  const std::string memory = "/dev/shm";
  return std::filesystem::is_directory(memory) ? memory : testing::TempDir();
}

}  // namespace

TestFolder::TestFolder() : TestFolder(FastFolder()) {}

TestFolder::TestFolder(const std::string& parent) : path_(parent + "/ccst-store-XXXXXX") {
  if (mkdtemp(path_.data()) == nullptr) std::abort();
}

TestFolder::~TestFolder() { std::filesystem::remove_all(path_); }

StoreTest::StoreTest() : directory_(folder_.path() + "/data") { Reopen(); }

void StoreTest::Reopen() {
  store_.reset();
  auto store = OpenEmbeddedStore(directory_);
  if (!store.ok()) {
    ADD_FAILURE() << store.status();
    std::abort();
  }
  store_ = *std::move(store);
}

absl::Time At(double seconds) {
  return absl::FromUnixSeconds(1'800'000'000) + absl::Seconds(seconds);
}

std::string Digest(std::string_view text) { return Sha256Of(text); }

JobRecord SomeJob(const std::string& id, absl::Time create_time) {
  JobRecord job;
  job.id = id;
  job.owner = "ann";
  job.request_id = "request of " + id;
  job.display_name = "the job " + id;
  job.labels = {{"project", "bunny"}, {"stage", "draft"}};
  job.mesh_sha256 = Digest("mesh");
  job.texture_sha256 = Digest("texture");
  job.spec_digest = Digest("spec");
  job.definition = std::string("options\0of", 10) + id;
  job.create_time = create_time;
  return job;
}

MeshRecord SomeMesh(const std::string& owner, const std::string& content, absl::Time create_time) {
  return {.owner = owner,
          .sha256 = Digest(content),
          .size_bytes = static_cast<std::int64_t>(content.size()),
          .display_name = "the mesh " + content,
          .create_time = create_time,
          .expire_time = create_time + absl::Hours(1),
          .facts = std::string("facts\0of", 8) + content};
}

JobRecord Ended(JobRecord job, absl::Time expire_time) {
  job.state = JobState::kSucceeded;
  job.start_time = job.create_time + absl::Milliseconds(1);
  job.end_time = job.create_time + absl::Milliseconds(20);
  job.expire_time = expire_time;
  job.outcome = std::string("figures\0", 8);
  job.samples_sha256 = Digest("samples of " + job.id);
  job.reusable = true;
  return job;
}

void ExpectSame(const JobRecord& actual, const JobRecord& expected) {
  EXPECT_EQ(actual.id, expected.id);
  EXPECT_EQ(actual.owner, expected.owner);
  EXPECT_EQ(actual.request_id, expected.request_id);
  EXPECT_EQ(actual.display_name, expected.display_name);
  EXPECT_EQ(actual.labels, expected.labels);
  EXPECT_EQ(actual.mesh_sha256, expected.mesh_sha256);
  EXPECT_EQ(actual.texture_sha256, expected.texture_sha256);
  EXPECT_EQ(actual.spec_digest, expected.spec_digest);
  EXPECT_EQ(actual.definition, expected.definition);
  EXPECT_EQ(actual.state, expected.state);
  EXPECT_EQ(actual.create_time, expected.create_time);
  EXPECT_EQ(actual.start_time, expected.start_time);
  EXPECT_EQ(actual.end_time, expected.end_time);
  EXPECT_EQ(actual.expire_time, expected.expire_time);
  EXPECT_EQ(actual.outcome, expected.outcome);
  EXPECT_EQ(actual.samples_sha256, expected.samples_sha256);
  EXPECT_EQ(actual.reusable, expected.reusable);
  EXPECT_EQ(actual.cached, expected.cached);
}

void ExpectSame(const MeshRecord& actual, const MeshRecord& expected) {
  EXPECT_EQ(actual.owner, expected.owner);
  EXPECT_EQ(actual.sha256, expected.sha256);
  EXPECT_EQ(actual.size_bytes, expected.size_bytes);
  EXPECT_EQ(actual.display_name, expected.display_name);
  EXPECT_EQ(actual.create_time, expected.create_time);
  EXPECT_EQ(actual.expire_time, expected.expire_time);
  EXPECT_EQ(actual.facts, expected.facts);
}

std::vector<std::string> Ids(const std::vector<JobRecord>& jobs) {
  std::vector<std::string> ids;
  for (const JobRecord& job : jobs) ids.push_back(job.id);
  return ids;
}

std::vector<std::string> Digests(const std::vector<MeshRecord>& meshes) {
  std::vector<std::string> digests;
  for (const MeshRecord& mesh : meshes) digests.push_back(mesh.sha256);
  return digests;
}

void ExpectError(const absl::Status& status, absl::StatusCode code, std::string_view reason) {
  EXPECT_EQ(status.code(), code) << status;
  const auto actual = GetErrorReason(status);
  ASSERT_TRUE(actual.has_value()) << status;
  EXPECT_EQ(ErrorReasonName(*actual), reason) << status;
}

}  // namespace ccst::server
