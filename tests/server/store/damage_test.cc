// Damaged blobs and rows: noticed, kept apart from what is whole, healed by the right bytes.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/store/sqlite.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

class Damage : public StoreTest {
 protected:
  std::string FileOf(const std::string& sha256) const {
    return directory_ + "/blobs/" + sha256.substr(0, 2) + "/" + sha256;
  }
  void Overwrite(const std::string& sha256, std::size_t offset, char byte) {
    std::fstream file(FileOf(sha256), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(offset));
    file << byte;
  }
  // Changes the records behind the store's back, as a disk would that leaves pages whole.
  void Change(const std::string& sql) {
    ASSERT_TRUE((*Database::Open(directory_ + "/records.sqlite"))->RunScript(sql).ok());
  }
  // An index that has no entry of job `id`, and is said to be of all.
  void Leave(const std::string& id, const std::string& index, const std::string& columns) {
    const std::string sql = "CREATE INDEX " + index + " " + columns;
    std::string quoted = sql;
    for (std::size_t i = 0; (i = quoted.find('\'', i)) != std::string::npos; i += 2) {
      quoted.insert(i, 1, '\'');
    }
    Change("DROP INDEX " + index + ";" + sql + " AND id <> '" + id + "';" +
           "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = '" + quoted +
           "' WHERE name = '" + index + "';");
    Reopen();
  }
  static void ExpectDamaged(const absl::Status& status) {
    ExpectError(status, absl::StatusCode::kDataLoss, "STORAGE_FAILED");
  }
};

TEST_F(Damage, OfABlobIsSeenHoweverItCameAbout) {
  const std::string sha256 = *PutWhole(store_->blobs(), "right bytes");
  EXPECT_TRUE(store_->blobs().Check(sha256).ok());
  Overwrite(sha256, 3, 'X');
  ExpectDamaged(store_->blobs().Check(sha256));
  ExpectDamaged(ReadWhole(store_->blobs(), sha256).status());
  for (const std::size_t size : {std::size_t{5}, std::size_t{0}}) {
    std::filesystem::resize_file(FileOf(sha256), size);
    ExpectDamaged(store_->blobs().Check(sha256));
    ExpectDamaged(ReadWhole(store_->blobs(), sha256).status());
  }
  std::filesystem::remove(FileOf(sha256));
  ExpectError(store_->blobs().Check(sha256), absl::StatusCode::kNotFound, "NOT_FOUND");
  ExpectError(store_->blobs().Check("no digest"), absl::StatusCode::kNotFound, "NOT_FOUND");
}

TEST_F(Damage, OfABlobIsSeenAfterItWasFoundRight) {
  const std::string sha256 = *PutWhole(store_->blobs(), "right bytes");
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "right bytes")).ok());
  Reopen();
  ASSERT_TRUE(store_->blobs().Check(sha256).ok());
  Overwrite(sha256, 0, 'X');
  ExpectDamaged(store_->blobs().Check(sha256));
  Overwrite(sha256, 0, 'r');
  EXPECT_TRUE(store_->blobs().Check(sha256).ok());
  Overwrite(sha256, 0, 'X');
  ExpectDamaged(store_->blobs().Check(sha256));
}

TEST_F(Damage, ThatNoWriteBroughtAboutIsSeenOnceAReaderDoubts) {
  const std::string sha256 = *PutWhole(store_->blobs(), "right bytes");
  const auto time = std::filesystem::last_write_time(FileOf(sha256));
  Overwrite(sha256, 0, 'X');
  std::filesystem::last_write_time(FileOf(sha256), time);
  EXPECT_TRUE(store_->blobs().Check(sha256).ok());
  ExpectDamaged(ReadWhole(store_->blobs(), sha256).status());
  ExpectDamaged(store_->blobs().Check(sha256));
}

TEST_F(Damage, OfABlobIsHealedByTheRightBytes) {
  const std::string bytes = "right bytes";
  const std::string sha256 = *PutWhole(store_->blobs(), bytes);
  for (const std::size_t size : {std::size_t{5}, std::size_t{0}, bytes.size()}) {
    std::filesystem::resize_file(FileOf(sha256), size);
    Overwrite(sha256, 0, 'X');
    ASSERT_TRUE(PutWhole(store_->blobs(), bytes).ok());
    EXPECT_TRUE(store_->blobs().Check(sha256).ok());
    EXPECT_EQ(*ReadWhole(store_->blobs(), sha256), bytes);
  }
}

TEST_F(Damage, IsSeenByAReaderInPiecesBeforeTheLastPiece) {
  const std::string sha256 = *PutWhole(store_->blobs(), "right bytes");
  Overwrite(sha256, 1, 'X');
  CheckedReader reader(*store_->blobs().Open(sha256), sha256);
  std::string piece(5, '\0');
  EXPECT_TRUE(reader.Next(piece).ok());
  EXPECT_TRUE(reader.Next(piece).ok());
  EXPECT_FALSE(reader.at_end());
  std::string last(1, '\0');
  ExpectDamaged(reader.Next(last));
}

TEST_F(Damage, ReaderInPiecesGivesWhatWasPut) {
  const std::string sha256 = *PutWhole(store_->blobs(), "right bytes");
  CheckedReader reader(*store_->blobs().Open(sha256), sha256);
  std::string bytes;
  for (const std::size_t size : {4, 1, 6}) {
    EXPECT_EQ(reader.offset(), static_cast<std::int64_t>(bytes.size()));
    std::string piece(size, '\0');
    ASSERT_TRUE(reader.Next(piece).ok());
    bytes += piece;
  }
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(bytes, "right bytes");
}

TEST_F(Damage, OfAnyPartOfAJobIsSeenAndTheOthersAreListed) {
  const std::vector<std::string> changes = {"definition = CAST('x' AS BLOB)",
                                            "outcome = CAST('x' AS BLOB)",
                                            "owner = 'bob'",
                                            "display_name = 'x'",
                                            "request_id = 'x'",
                                            "mesh_sha256 = 'x'",
                                            "texture_sha256 = 'x'",
                                            "samples_sha256 = 'x'",
                                            "spec_digest = 'x'",
                                            "create_time = create_time + 1",
                                            "start_time = NULL",
                                            "end_time = end_time + 1",
                                            "expire_time = expire_time + 1",
                                            "reusable = 0",
                                            "cached = 1",
                                            "state = 'failed'",
                                            "history_sha256 = ''"};
  for (std::size_t i = 0; i <= changes.size(); ++i) {
    const JobRecord job = SomeJob(std::to_string(i), At(static_cast<double>(i)));
    ASSERT_TRUE(store_->AddJob(job).ok());
    ASSERT_TRUE(store_->EndJob(Ended(job), "history").ok());
  }
  std::string sql;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    sql += "UPDATE jobs SET " + changes[i] + " WHERE id = '" + std::to_string(i) + "';";
  }
  Change(sql);
  const auto page = store_->ListJobs({}, 100, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->records.size(), changes.size() + 1);
  for (const JobRecord& job : page->records) {
    EXPECT_EQ(job.damaged, job.id != std::to_string(changes.size())) << job.id;
  }
}

TEST_F(Damage, OfALabelOrAStateThatIsNoneIsSeen) {
  for (const char* id : {"label", "added", "state", "whole"}) {
    ASSERT_TRUE(store_->AddJob(SomeJob(id)).ok());
  }
  Change(
      "UPDATE job_labels SET value = 'x' WHERE job_id = 'label' AND name = 'stage';"
      "INSERT INTO job_labels SELECT job_id, 'more', value, owner, mesh_sha256, create_time "
      "FROM job_labels WHERE job_id = 'added' AND name = 'stage';"
      "PRAGMA ignore_check_constraints = ON;"
      "UPDATE jobs SET state = 'qu' WHERE id = 'state';");
  const auto page = store_->ListJobs({}, 100, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->records.size(), 4U);
  for (const JobRecord& job : page->records) EXPECT_EQ(job.damaged, job.id != "whole") << job.id;
}

TEST_F(Damage, IsNotSeenInWhatChangesByItself) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->MarkCancelling("a").ok());
  EXPECT_FALSE((*store_->GetJob("a"))->damaged);
  ASSERT_TRUE(store_->EndJob(Ended(job), "history").ok());
  EXPECT_FALSE((*store_->GetJob("a"))->damaged);
  JobRecord later = SomeJob("b", At(1) + absl::Nanoseconds(1));  // Finer than records.
  ASSERT_TRUE(store_->AddEndedJob(Ended(later), "history").ok());
  EXPECT_FALSE((*store_->GetJob("b"))->damaged);
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "mesh")).ok());
  ASSERT_TRUE(store_->TouchMesh("ann", Digest("mesh"), At(1e6)).ok());
  EXPECT_FALSE((*store_->GetMesh("ann", Digest("mesh")))->damaged);
}

TEST_F(Damage, OfAMeshIsSeenAndHealedByPuttingItAgain) {
  for (const char* content : {"facts", "name", "size", "time", "whole"}) {
    ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", content)).ok());
  }
  const auto change = [](const std::string& what, const char* content) {
    return "UPDATE meshes SET " + what + " WHERE sha256 = '" + Digest(content) + "';";
  };
  Change(change("facts = CAST('x' AS BLOB)", "facts") + change("display_name = 'x'", "name") +
         change("size_bytes = 1", "size") + change("create_time = 1", "time"));
  const auto page = store_->ListMeshes("ann", 100, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->records.size(), 5U);
  for (const MeshRecord& mesh : page->records) {
    EXPECT_EQ(mesh.damaged, mesh.sha256 != Digest("whole")) << mesh.display_name;
  }
  ASSERT_TRUE(store_->PutMesh(SomeMesh("ann", "facts")).ok());
  EXPECT_FALSE((*store_->GetMesh("ann", Digest("facts")))->damaged);
}

TEST_F(Damage, OfAnIndexKeepsNoJobFromBeingRun) {
  ASSERT_TRUE(store_->AddJob(SomeJob("lost")).ok());
  ASSERT_TRUE(store_->AddJob(SomeJob("other")).ok());
  Leave("lost", "jobs_unfinished",
        "ON jobs (create_time, id) WHERE state IN ('queued', 'cancelling')");
  const auto unfinished = store_->UnfinishedJobs();
  ASSERT_TRUE(unfinished.ok()) << unfinished.status();
  EXPECT_EQ(unfinished->size(), 2U);
  EXPECT_TRUE(store_->EndJob(Ended(SomeJob("lost")), "").ok());
}

TEST_F(Damage, OfAnIndexKeepsNothingFromBeingDropped) {
  for (const char* id : {"deleted", "lost", "other"}) {
    ASSERT_TRUE(store_->AddEndedJob(Ended(SomeJob(id)), "history").ok());
  }
  const std::string columns = "ON jobs (samples_sha256) WHERE samples_sha256 <> ''";
  Leave("deleted", "jobs_samples", columns);
  EXPECT_TRUE(store_->DeleteJob("deleted").ok());
  Leave("lost", "jobs_samples", columns);
  for (int i = 0; i < 2; ++i) {
    const auto dropped = store_->DropExpiredJobs(absl::InfiniteFuture(), 10);
    ASSERT_TRUE(dropped.ok()) << dropped.status();
  }
  EXPECT_TRUE(store_->ListJobs({}, 10, "")->records.empty());
}

TEST_F(Damage, OfANameKeepsNoJobFromBeingDropped) {
  const JobRecord job = Ended(SomeJob("name-of-a-job"));
  ASSERT_TRUE(store_->AddEndedJob(job, "history").ok());
  store_.reset();
  // In the row alone, where these follow one another; the indexes have the name as it was.
  std::fstream file(directory_ + "/records.sqlite",
                    std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const std::size_t place = bytes.find(job.id + job.owner + job.request_id + job.display_name);
  ASSERT_NE(place, std::string::npos);
  file.seekp(static_cast<std::streamoff>(place));
  file << '\xff';
  file.close();
  Reopen();
  const auto page = store_->ListJobs({}, 10, "");
  ASSERT_TRUE(page.ok()) << page.status();
  ASSERT_EQ(page->records.size(), 1U);
  const auto dropped = store_->DropExpiredJobs(absl::InfiniteFuture(), 10);
  ASSERT_TRUE(dropped.ok()) << dropped.status();
  EXPECT_EQ(dropped->size(), 1U);
  EXPECT_TRUE(store_->DropExpiredJobs(absl::InfiniteFuture(), 10)->empty());
}

TEST_F(Damage, OfAHistoryIsSeenWhenItIsRead) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ASSERT_TRUE(store_->EndJob(Ended(job), "history").ok());
  Change("UPDATE histories SET history = CAST('hisTory' AS BLOB)");
  ExpectDamaged(store_->GetHistory("a").status());
  EXPECT_FALSE((*store_->GetJob("a"))->damaged);
  const JobRecord other = SomeJob("b");
  ASSERT_TRUE(store_->AddEndedJob(Ended(other), "history").ok());  // The right bytes again.
  EXPECT_EQ(*store_->GetHistory("a"), "history");
  Change("DELETE FROM histories");
  ExpectDamaged(store_->GetHistory("a").status());
}

}  // namespace
}  // namespace ccst::server
