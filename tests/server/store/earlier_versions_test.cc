// Records that earlier versions of the schema wrote are read, counted and go on.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/record_bytes.h"
#include "server/store/schema.h"
#include "server/store/sqlite.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;

class EarlierVersions : public testing::TestWithParam<int> {
 protected:
  // Records of that version: a job that ended with a history, one that waits, a mesh.
  EarlierVersions() : directory_(folder_.path() + "/data") {
    std::filesystem::create_directory(directory_);
    const auto database = *Database::Open(directory_ + "/records.sqlite");
    const auto version = static_cast<std::size_t>(GetParam());
    EXPECT_TRUE(MigrateSchema(*database, SchemaMigrations().first(version)).ok());
    Write(*database, Ended(SomeJob("a", At(1))));
    Write(*database, SomeJob("b", At(2)));
    const std::string history = "history of a";
    EXPECT_TRUE(database->Once("INSERT INTO job_histories VALUES ('a', ?, ?)")
                    .Bind(Bytes{history})
                    .Bind(Digest(history))
                    .Run()
                    .ok());
    const MeshRecord mesh = SomeMesh("ann", "mesh");
    EXPECT_TRUE(database
                    ->Once("INSERT INTO meshes (owner, sha256, size_bytes, display_name, "
                           "create_time, expire_time, facts) VALUES (?, ?, ?, ?, ?, ?, ?)")
                    .Bind(mesh.owner)
                    .Bind(mesh.sha256)
                    .Bind(mesh.size_bytes)
                    .Bind(mesh.display_name)
                    .Bind(mesh.create_time)
                    .Bind(mesh.expire_time)
                    .Bind(Bytes{mesh.facts})
                    .Run()
                    .ok());
  }

  static void Write(Database& database, const JobRecord& job) {
    EXPECT_TRUE(database
                    .Once("INSERT INTO jobs (id, owner, request_id, display_name, mesh_sha256, "
                          "texture_sha256, spec_digest, definition, state, create_time, "
                          "start_time, end_time, expire_time, outcome, samples_sha256, reusable, "
                          "cached) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
                    .Bind(job.id)
                    .Bind(job.owner)
                    .Bind(job.request_id)
                    .Bind(job.display_name)
                    .Bind(job.mesh_sha256)
                    .Bind(job.texture_sha256)
                    .Bind(job.spec_digest)
                    .Bind(Bytes{job.definition})
                    .Bind(job.state == JobState::kQueued ? "queued" : "succeeded")
                    .Bind(job.create_time)
                    .Bind(job.start_time)
                    .Bind(job.end_time)
                    .Bind(job.expire_time)
                    .Bind(Bytes{job.outcome})
                    .Bind(job.samples_sha256)
                    .Bind(job.reusable)
                    .Bind(job.cached)
                    .Run()
                    .ok());
    for (const auto& [name, value] : job.labels) {
      EXPECT_TRUE(database.Once("INSERT INTO job_labels VALUES (?, ?, ?, ?, ?, ?)")
                      .Bind(job.id)
                      .Bind(name)
                      .Bind(value)
                      .Bind(job.owner)
                      .Bind(job.mesh_sha256)
                      .Bind(job.create_time)
                      .Run()
                      .ok());
    }
  }

  const TestFolder folder_;
  const std::string directory_;
};

TEST_P(EarlierVersions, AreReadAsTheyWereWritten) {
  const auto store = *OpenEmbeddedStore(directory_);
  ExpectSame(**store->GetJob("a"), Ended(SomeJob("a", At(1))));
  ExpectSame(**store->GetJob("b"), SomeJob("b", At(2)));
  ExpectSame(**store->GetMesh("ann", Digest("mesh")), SomeMesh("ann", "mesh"));
  EXPECT_EQ(*store->GetHistory("a"), "history of a");
  EXPECT_EQ(*store->GetHistory("b"), "");
  const auto jobs = store->ListJobs({}, 10, "")->records;
  EXPECT_THAT(Ids(jobs), ElementsAre("b", "a"));
  for (const JobRecord& job : jobs) {
    EXPECT_FALSE(job.damaged);
    EXPECT_EQ(job.starts, 0);
  }
  EXPECT_FALSE((*store->GetMesh("ann", Digest("mesh")))->damaged);
}

TEST_P(EarlierVersions, AreCountedAndGoOn) {
  const auto store = *OpenEmbeddedStore(directory_);
  const JobRecord ended = Ended(SomeJob("a", At(1)));
  const JobRecord waiting = SomeJob("b", At(2));
  const std::int64_t mesh = BytesOf(SomeMesh("ann", "mesh"));
  EXPECT_EQ(*store->RecordBytes("ann"),
            BytesOf(ended) + BytesOf(waiting) + mesh + static_cast<std::int64_t>(12));
  ASSERT_TRUE(store->EndJob(Ended(waiting), "another history").ok());
  EXPECT_EQ(*store->GetHistory("b"), "another history");
  ASSERT_TRUE(store->DeleteJob("a").ok());
  ASSERT_TRUE(store->DeleteJob("b").ok());
  EXPECT_EQ(*store->RecordBytes("ann"), mesh);
  ASSERT_TRUE(store->DeleteMesh("ann", Digest("mesh")).ok());
  EXPECT_EQ(*store->AllRecordBytes(), 0);
}

INSTANTIATE_TEST_SUITE_P(OfTheSchema, EarlierVersions, testing::Values(1, 2, 3),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace ccst::server
