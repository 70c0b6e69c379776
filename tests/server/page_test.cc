#include "server/rpc/page.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/status/statusor.h"
#include "ccst/v1/job.pb.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::Le;
using testing::SizeIs;

// A list of texts. A token is the number of the first text of the page.
class Texts {
 public:
  explicit Texts(std::vector<std::string> texts) : texts_(std::move(texts)) {}

  // The sizes of all pages of at most `page_size` entries, whose texts must be all texts in turn.
  std::vector<int> PageSizes(int page_size) {
    std::vector<int> sizes;
    std::size_t seen = 0;
    std::string token;
    do {
      google::protobuf::RepeatedPtrField<v1::Job> entries;
      std::string next;
      const absl::Status status = FillPage(
          page_size, [&](int size) { return Page(size, token); },
          [](const std::string& text) {
            v1::Job job;
            job.set_display_name(text);
            return job;
          },
          entries, next);
      EXPECT_TRUE(status.ok());
      for (const v1::Job& job : entries) EXPECT_EQ(job.display_name(), texts_.at(seen++));
      sizes.push_back(entries.size());
      token = next;
    } while (!token.empty());
    EXPECT_EQ(seen, texts_.size());
    return sizes;
  }

 private:
  absl::StatusOr<server::Page<std::string>> Page(int size, const std::string& token) const {
    const std::size_t begin = token.empty() ? 0 : std::stoul(token);
    const std::size_t end = std::min(texts_.size(), begin + static_cast<std::size_t>(size));
    server::Page<std::string> page;
    page.records.assign(texts_.begin() + static_cast<std::ptrdiff_t>(begin),
                        texts_.begin() + static_cast<std::ptrdiff_t>(end));
    if (end < texts_.size()) page.next_token = std::to_string(end);
    return page;
  }

  const std::vector<std::string> texts_;
};

constexpr std::size_t kHalf = kMaxPageBytes / 2;

TEST(FillPage, SmallEntriesFillPagesByTheirNumber) {
  EXPECT_THAT(Texts(std::vector<std::string>(5, "x")).PageSizes(2), ElementsAre(2, 2, 1));
  EXPECT_THAT(Texts({}).PageSizes(2), ElementsAre(0));
}

TEST(FillPage, LargeEntriesEndAPageByTheirBytes) {
  const std::vector<std::string> texts(7, std::string(kHalf - 100, 'x'));
  EXPECT_THAT(Texts(texts).PageSizes(1000), ElementsAre(2, 2, 2, 1));
}

TEST(FillPage, EntryThatIsLargerThanAPageHasOneOfItsOwn) {
  const std::string large(3 * kHalf, 'x');
  EXPECT_THAT(Texts({"a", large, "b", "c"}).PageSizes(10), ElementsAre(1, 1, 2));
}

TEST(FillPage, ErrorOfTheListIsPassedOn) {
  google::protobuf::RepeatedPtrField<v1::Job> entries;
  std::string token;
  const auto list = [](int) -> absl::StatusOr<Page<int>> { return absl::InternalError("no"); };
  EXPECT_EQ(FillPage(
                1, list, [](int) { return v1::Job(); }, entries, token),
            absl::InternalError("no"));
}

}  // namespace
}  // namespace ccst::server
