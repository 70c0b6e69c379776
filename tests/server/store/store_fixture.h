#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/store/store.h"

namespace ccst::server {

/// A folder for a test, removed with all in it. In memory where the system has such a place, as
/// synchronizing a busy disk takes most of the time of these tests.
class TestFolder {
 public:
  TestFolder();
  /// Within `parent`.
  explicit TestFolder(const std::string& parent);
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// An embedded store in a folder of its own.
class StoreTest : public testing::Test {
 protected:
  StoreTest();

  /// What a restart of the server does.
  void Reopen();

  const TestFolder folder_;
  const std::string directory_;
  std::unique_ptr<Store> store_;
};

/// A moment `seconds` after one that is the same in all tests.
absl::Time At(double seconds);

/// The SHA-256 of `text`; digests that tests need.
std::string Digest(std::string_view text);

/// A waiting job and a mesh that have something in every field.
JobRecord SomeJob(const std::string& id, absl::Time create_time = At(0));
MeshRecord SomeMesh(const std::string& owner, const std::string& content,
                    absl::Time create_time = At(0));

/// `job` after it succeeded; its result expires at `expire_time`.
JobRecord Ended(JobRecord job, absl::Time expire_time = At(1000));

/// Equal in all fields; says which is not.
void ExpectSame(const JobRecord& actual, const JobRecord& expected);
void ExpectSame(const MeshRecord& actual, const MeshRecord& expected);

/// Ids of jobs, digests of meshes, in order.
std::vector<std::string> Ids(const std::vector<JobRecord>& jobs);
std::vector<std::string> Digests(const std::vector<MeshRecord>& meshes);

/// `status` has this code and reason.
void ExpectError(const absl::Status& status, absl::StatusCode code, std::string_view reason);

}  // namespace ccst::server
