#include <algorithm>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/store/store_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class JobLists : public StoreTest {
 protected:
  // All pages of this size, one after the other.
  std::vector<std::string> Walk(const JobFilter& filter, int page_size) {
    std::vector<std::string> ids;
    std::string token;
    do {
      const auto page = *store_->ListJobs(filter, page_size, token);
      EXPECT_LE(page.records.size(), page_size);
      for (const std::string& id : Ids(page.records)) ids.push_back(id);
      token = page.next_token;
    } while (!token.empty());
    return ids;
  }
};

TEST_F(JobLists, EmptyStoreGivesOneEmptyPage) {
  const auto page = *store_->ListJobs({}, 10, "");
  EXPECT_THAT(page.records, IsEmpty());
  EXPECT_TRUE(page.next_token.empty());
}

TEST_F(JobLists, CarryWholeRecords) {
  const JobRecord job = SomeJob("a");
  ASSERT_TRUE(store_->AddJob(job).ok());
  ExpectSame(store_->ListJobs({}, 10, "")->records.at(0), job);
}

TEST_F(JobLists, FullLastPageHasNoToken) {
  for (const char* id : {"a", "b"}) ASSERT_TRUE(store_->AddJob(SomeJob(id)).ok());
  EXPECT_TRUE(store_->ListJobs({}, 2, "")->next_token.empty());
  EXPECT_FALSE(store_->ListJobs({}, 1, "")->next_token.empty());
}

TEST_F(JobLists, PagesStayWhileJobsAreAddedAndDeleted) {
  for (const char* id : {"a", "b", "c", "d"}) {
    ASSERT_TRUE(store_->AddJob(SomeJob(id, At(id[0]))).ok());
  }
  const auto first = *store_->ListJobs({}, 2, "");
  EXPECT_THAT(Ids(first.records), ElementsAre("d", "c"));
  ASSERT_TRUE(store_->AddJob(SomeJob("e", At('e'))).ok());
  ASSERT_TRUE(store_->DeleteJob("c").ok());
  const auto second = *store_->ListJobs({}, 2, first.next_token);
  EXPECT_THAT(Ids(second.records), ElementsAre("b", "a"));
}

TEST_F(JobLists, ForeignTokensAreRefused) {
  for (const char* token : {"x", "AAAA", "????", "MTIzNDU2Nzg5MDEyMzQ1Njc4OTA"}) {
    ExpectError(store_->ListJobs({}, 10, token).status(), absl::StatusCode::kInvalidArgument,
                "REQUEST_INVALID");
  }
}

// Every combination of filters against a plain loop over the same jobs.
TEST_F(JobLists, KeepWhatTheFilterAsksForNewestFirst) {
  std::mt19937 random(7);
  const auto one_of = [&random](const std::vector<std::string>& values) {
    return values[random() % values.size()];
  };
  const std::vector<std::string> owners = {"ann", "bob"};
  const std::vector<std::string> meshes = {Digest("one"), Digest("two")};
  const std::vector<JobState> states = {JobState::kQueued, JobState::kCancelling,
                                        JobState::kSucceeded, JobState::kFailed,
                                        JobState::kCancelled};
  std::vector<JobRecord> jobs;
  for (int i = 0; i < 120; ++i) {
    JobRecord job = SomeJob("job " + std::to_string(i), At(random() % 20));
    job.owner = one_of(owners);
    job.mesh_sha256 = one_of(meshes);
    job.state = states[random() % states.size()];
    job.labels.clear();
    for (const char* name : {"p", "q"}) {
      if (random() % 4 != 0) job.labels[name] = one_of({"1", "2"});
    }
    ASSERT_TRUE(store_->AddJob(job).ok());
    jobs.push_back(job);
  }
  std::sort(jobs.begin(), jobs.end(), [](const JobRecord& a, const JobRecord& b) {
    return std::tie(a.create_time, a.id) > std::tie(b.create_time, b.id);
  });

  const std::vector<std::vector<JobState>> state_choices = {
      {}, {JobState::kFailed}, {JobState::kQueued, JobState::kSucceeded}};
  const std::vector<std::map<std::string, std::string>> label_choices = {
      {}, {{"p", "1"}}, {{"p", "2"}, {"q", "1"}}, {{"p", "3"}}, {{"none", "1"}}};
  for (int mask = 0; mask < 4; ++mask) {
    for (const auto& state_choice : state_choices) {
      for (const auto& labels : label_choices) {
        JobFilter filter;
        if ((mask & 1) != 0) filter.owner = "bob";
        if ((mask & 2) != 0) filter.mesh_sha256 = meshes[1];
        filter.states = state_choice;
        filter.labels = labels;
        std::vector<std::string> expected;
        for (const JobRecord& job : jobs) {
          const bool has_labels =
              std::all_of(labels.begin(), labels.end(), [&job](const auto& label) {
                const auto found = job.labels.find(label.first);
                return found != job.labels.end() && found->second == label.second;
              });
          if ((!filter.owner.has_value() || job.owner == *filter.owner) && has_labels &&
              (filter.mesh_sha256.empty() || job.mesh_sha256 == filter.mesh_sha256) &&
              (filter.states.empty() ||
               std::count(filter.states.begin(), filter.states.end(), job.state) != 0)) {
            expected.push_back(job.id);
          }
        }
        EXPECT_EQ(Walk(filter, 3), expected);
        EXPECT_EQ(Walk(filter, 1000), expected);
      }
    }
  }
}

}  // namespace
}  // namespace ccst::server
