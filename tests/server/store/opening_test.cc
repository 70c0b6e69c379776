#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/store/schema.h"
#include "server/store/sqlite.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::HasSubstr;

class Opening : public testing::Test {
 protected:
  Opening() : directory_(folder_.path() + "/data"), records_(directory_ + "/records.sqlite") {}

  // A store with `count` ended jobs, closed again.
  void Fill(int count) {
    auto store = *OpenEmbeddedStore(directory_);
    for (int i = 0; i < count; ++i) {
      const JobRecord job = SomeJob(std::to_string(i), At(i));
      ASSERT_TRUE(store->AddJob(job).ok());
      ASSERT_TRUE(store->EndJob(Ended(job), HistoryOf(job.id)).ok());
    }
  }

  // Of each job another, as equal ones are stored once.
  static std::string HistoryOf(const std::string& id) { return std::string(10000, 'h') + id; }

  // The error names the directory as it was given; the damaged file is left as it is.
  void ExpectDamageIsReported() {
    const auto size = std::filesystem::file_size(records_);
    const auto store = OpenEmbeddedStore(directory_);
    ASSERT_FALSE(store.ok());
    ExpectError(store.status(), absl::StatusCode::kInternal, "STORAGE_FAILED");
    EXPECT_THAT(std::string(store.status().message()), HasSubstr(directory_));
    EXPECT_THAT(std::string(store.status().message()), HasSubstr("records"));
    EXPECT_EQ(std::filesystem::file_size(records_), size);
  }

  // How many histories of Fill() are refused; the others are as they were.
  std::size_t DamagedHistories(Store& store) {
    std::size_t damaged = 0;
    for (const std::string& id : Ids(store.ListJobs({}, 1000, "")->records)) {
      const auto history = store.GetHistory(id);
      if (history.ok()) {
        EXPECT_EQ(*history, HistoryOf(id));
      } else {
        ExpectError(history.status(), absl::StatusCode::kDataLoss, "STORAGE_FAILED");
        ++damaged;
      }
    }
    return damaged;
  }

  std::int64_t VersionOf(Database& database) {
    Statement statement = database.Once("PRAGMA user_version");
    return statement.Next() ? statement.Int(0) : -1;
  }

  const TestFolder folder_;
  const std::string directory_;
  const std::string records_;
};

TEST_F(Opening, MakesFoldersForTheOwnerAlone) {
  const std::string deep = folder_.path() + "/a/b/../c/";
  auto store = OpenEmbeddedStore(deep);
  ASSERT_TRUE(store.ok()) << store.status();
  ASSERT_TRUE(PutWhole((*store)->blobs(), "blob").ok());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(deep)) {
    struct stat facts = {};
    ASSERT_EQ(stat(entry.path().c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 0777, entry.is_directory() ? 0700 : 0600) << entry.path();
  }
  EXPECT_EQ(std::filesystem::status(deep).permissions(), std::filesystem::perms::owner_all);
}

TEST_F(Opening, TwiceInOneProcessIsRefusedAndNamesTheDirectory) {
  const auto first = OpenEmbeddedStore(directory_);
  const auto second = OpenEmbeddedStore(directory_);
  ExpectError(second.status(), absl::StatusCode::kFailedPrecondition, "STORAGE_FAILED");
  EXPECT_THAT(std::string(second.status().message()), HasSubstr(directory_));
  EXPECT_TRUE((*first)->AddJob(SomeJob("a")).ok());
}

TEST_F(Opening, WorksAgainAfterTheFirstIsClosed) {
  ASSERT_TRUE(OpenEmbeddedStore(directory_).ok());
  EXPECT_TRUE(OpenEmbeddedStore(directory_).ok());
}

TEST_F(Opening, AFileInPlaceOfTheDirectoryIsRefused) {
  std::ofstream(directory_) << "a file";
  const auto store = OpenEmbeddedStore(directory_);
  ExpectError(store.status(), absl::StatusCode::kInternal, "STORAGE_FAILED");
  EXPECT_THAT(std::string(store.status().message()), HasSubstr(directory_));
}

TEST_F(Opening, RandomBytesForRecordsAreRefused) {
  std::filesystem::create_directory(directory_);
  std::string noise;
  for (int i = 0; i < 10000; ++i) noise += static_cast<char>(i * 7919 >> 3);
  std::ofstream(records_) << noise;
  ExpectDamageIsReported();
}

TEST_F(Opening, ATruncatedFileOfRecordsIsRefused) {
  Fill(20);
  std::filesystem::resize_file(records_, std::filesystem::file_size(records_) / 2 / 4096 * 4096);
  ExpectDamageIsReported();
}

TEST_F(Opening, AZeroedPageOfRecordsIsNoticedWhereverItIs) {
  Fill(20);
  std::string whole;
  {
    std::ifstream file(records_, std::ios::binary);
    whole.assign(std::istreambuf_iterator<char>(file), {});
  }
  const std::size_t page_count = whole.size() / 4096;
  std::size_t refused = 0;
  std::size_t damaged_histories = 0;
  for (std::size_t page = 0; page < page_count; ++page) {
    std::string damaged = whole;
    damaged.replace(page * 4096, 4096, 4096, '\0');
    std::ofstream(records_, std::ios::binary) << damaged;
    std::filesystem::remove(records_ + "-wal");
    SCOPED_TRACE(page);
    if (auto store = OpenEmbeddedStore(directory_); !store.ok()) {
      ExpectError(store.status(), absl::StatusCode::kInternal, "STORAGE_FAILED");
      ++refused;
    } else {
      // Within a history; that is noticed when it is read.
      damaged_histories += DamagedHistories(**store);
    }
  }
  EXPECT_GT(refused, page_count / 2);
  EXPECT_EQ(refused + damaged_histories, page_count);
}

TEST_F(Opening, RecordsOfANewerVersionAreRefusedAndLeftAlone) {
  Fill(1);
  {
    const auto database = *Database::Open(records_);
    ASSERT_TRUE(database->RunScript("PRAGMA user_version = 1000").ok());
  }
  const auto store = OpenEmbeddedStore(directory_);
  ExpectError(store.status(), absl::StatusCode::kFailedPrecondition, "STORAGE_FAILED");
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("1000"));
  EXPECT_EQ(VersionOf(**Database::Open(records_)), 1000);
}

TEST_F(Opening, AnEmptyFileBecomesTheCurrentVersion) {
  std::filesystem::create_directory(directory_);
  std::ofstream(records_).flush();
  ASSERT_TRUE(OpenEmbeddedStore(directory_).ok());
  EXPECT_EQ(VersionOf(**Database::Open(records_)), SchemaMigrations().size());
}

TEST_F(Opening, MigrationsRunOnceAndKeepWhatIsThere) {
  const std::string path = folder_.path() + "/old.sqlite";
  const Migration migrations[] = {
      {"CREATE TABLE points (x INTEGER); INSERT INTO points VALUES (1);"},
      {"ALTER TABLE points ADD COLUMN y INTEGER NOT NULL DEFAULT 7;"},
      {"", [](Database& points) { return points.RunScript("UPDATE points SET y = y + x;"); }},
  };
  ASSERT_TRUE(MigrateSchema(**Database::Open(path), {migrations, 1}).ok());
  const auto database = *Database::Open(path);
  EXPECT_EQ(VersionOf(*database), 1);
  for (int run = 0; run < 2; ++run) {
    ASSERT_TRUE(MigrateSchema(*database, migrations).ok());
    EXPECT_EQ(VersionOf(*database), 3);
    Statement statement = database->Once("SELECT x, y FROM points");
    ASSERT_TRUE(statement.Next());
    EXPECT_EQ(statement.Int(0), 1);
    EXPECT_EQ(statement.Int(1), 8);
  }
}

TEST_F(Opening, AMigrationThatFailsChangesNothing) {
  const auto database = *Database::Open(folder_.path() + "/old.sqlite");
  const Migration migrations[] = {
      {"CREATE TABLE points (x INTEGER);"},
      {"INSERT INTO points VALUES (1); INSERT INTO nowhere VALUES (1);"},
  };
  EXPECT_FALSE(MigrateSchema(*database, migrations).ok());
  EXPECT_EQ(VersionOf(*database), 1);
  Statement statement = database->Once("SELECT count(*) FROM points");
  ASSERT_TRUE(statement.Next());
  EXPECT_EQ(statement.Int(0), 0);
}

TEST_F(Opening, ARewriteThatFailsChangesNothing) {
  const auto database = *Database::Open(folder_.path() + "/old.sqlite");
  const Migration migrations[] = {
      {"CREATE TABLE points (x INTEGER);"},
      {"INSERT INTO points VALUES (1);",
       [](Database&) -> absl::Status { return absl::InternalError("damaged"); }},
  };
  EXPECT_FALSE(MigrateSchema(*database, migrations).ok());
  EXPECT_EQ(VersionOf(*database), 1);
  Statement statement = database->Once("SELECT count(*) FROM points");
  ASSERT_TRUE(statement.Next());
  EXPECT_EQ(statement.Int(0), 0);
}

}  // namespace
}  // namespace ccst::server
