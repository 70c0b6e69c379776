#include "core/io/atomic_file.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/core/io/io_test_util.h"

namespace ccst {
namespace {

namespace fs = std::filesystem;

std::size_t FilesIn(const std::string& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(WriteFileAtomically, WritesAndReplacesWholeFiles) {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "file";
  ASSERT_TRUE(WriteFileAtomically(path, "first").ok());
  EXPECT_EQ(testing::ReadBytes(path), "first");
  const std::string large(3 << 20, 'x');
  ASSERT_TRUE(WriteFileAtomically(path, large).ok());
  EXPECT_EQ(testing::ReadBytes(path), large);
  ASSERT_TRUE(WriteFileAtomically(path, "").ok());
  EXPECT_EQ(testing::ReadBytes(path), "");
  EXPECT_EQ(FilesIn(folder.path()), 1u);
}

TEST(WriteFileAtomically, ReadersOfTheOldFileKeepIt) {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "file";
  ASSERT_TRUE(WriteFileAtomically(path, "old").ok());
  fs::create_hard_link(path, folder / "kept");
  ASSERT_TRUE(WriteFileAtomically(path, "new").ok());
  EXPECT_EQ(testing::ReadBytes(folder / "kept"), "old");
  EXPECT_EQ(testing::ReadBytes(path), "new");
}

TEST(WriteFileAtomically, FailureLeavesTheOldFileAndNothingElse) {
  const testing::TemporaryFolder folder;
  ASSERT_EQ(mkdir((folder / "dir").c_str(), 0777), 0);
  const absl::Status status = WriteFileAtomically(folder / "dir", "new");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(status.ToString().find(folder / "dir"), std::string::npos);
  EXPECT_EQ(WriteFileAtomically(folder / "none/file", "new").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(FilesIn(folder.path()), 1u);
}

TEST(WriteFileAtomically, PermissionsStay) {
  const testing::TemporaryFolder folder;
  const std::string path = folder / "file";
  const mode_t mask = umask(022);
  ASSERT_TRUE(WriteFileAtomically(path, "first").ok());
  struct stat info = {};
  ASSERT_EQ(stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0644u);
  ASSERT_EQ(chmod(path.c_str(), 0606), 0);
  ASSERT_TRUE(WriteFileAtomically(path, "second").ok());
  ASSERT_EQ(stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0606u);
  umask(mask);
}

TEST(WriteFileAtomically, SymbolicLinksStay) {
  const testing::TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder / "file", "first").ok());
  fs::create_symlink("file", folder / "link");
  ASSERT_TRUE(WriteFileAtomically(folder / "link", "second").ok());
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(testing::ReadBytes(folder / "file"), "second");
}

TEST(WriteFileAtomically, DevicesAreWrittenInPlace) {
  EXPECT_TRUE(WriteFileAtomically("/dev/null", "gone").ok());
  struct stat info = {};
  ASSERT_EQ(stat("/dev/null", &info), 0);
  EXPECT_TRUE(S_ISCHR(info.st_mode));
  EXPECT_EQ(WriteFileAtomically("/dev/full", "x").code(), absl::StatusCode::kResourceExhausted);
}

TEST(WriteFileAtomically, DashIsStandardOutput) {
  ::testing::internal::CaptureStdout();
  EXPECT_TRUE(WriteFileAtomically("-", "to the terminal").ok());
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "to the terminal");
}

}  // namespace
}  // namespace ccst
