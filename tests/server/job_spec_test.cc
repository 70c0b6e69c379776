#include "server/jobs/job_spec.h"

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>

#include <gtest/gtest.h>

#include "core/sampling/option_table.h"

namespace ccst::server {
namespace {

// Each gives the field another value than it has.
void Change(bool& field) { field = !field; }
void Change(std::string& field) { field += 'x'; }
template <typename Number>
requires std::is_arithmetic_v<Number>
void Change(Number& field) { field += 1; }
template <typename Enum>
requires std::is_enum_v<Enum>
void Change(Enum& field) { field = static_cast<Enum>(static_cast<int>(field) + 1); }
template <typename Field>
void Change(std::optional<Field>& field) {
  field = field.value_or(Field()) + 1;
}

TEST(SpecDigest, EveryOptionThatChangesSamplesGivesAnother) {
  JobSpec spec;
  const std::string unchanged = SpecDigest(spec);
  std::set<std::string> digests = {unchanged};
  VisitOptions(spec.options, [&](const auto& option, auto& field) {
    // Of an image the digest counts, which is not among the options.
    if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(option)>, ImageOption>) {
      const auto before = field;
      Change(field);
      const std::string digest = SpecDigest(spec);
      if (option.info.changes_samples) {
        EXPECT_TRUE(digests.insert(digest).second) << option.info.name;
      } else {
        EXPECT_EQ(digest, unchanged) << option.info.name;
      }
      field = before;
    }
  });
  EXPECT_EQ(SpecDigest(spec), unchanged);
  EXPECT_GE(digests.size(), 15U);
}

TEST(SpecDigest, OptionsThatDoNotChangeSamplesAreTheseAlone) {
  std::set<std::string_view> names;
  const SamplingOptions options;
  VisitOptions(options, [&names](const auto& option, const auto& /*field*/) {
    if (!option.info.changes_samples) names.insert(option.info.name);
  });
  EXPECT_EQ(names, (std::set<std::string_view>{"thread_count", "time_limit_seconds"}));
}

TEST(SpecDigest, MeshAndImageCount) {
  std::set<std::string> digests = {SpecDigest(JobSpec())};
  JobSpec spec;
  spec.mesh_sha256 = std::string("other");
  EXPECT_TRUE(digests.insert(SpecDigest(spec)).second);
  spec = JobSpec();
  spec.texture_sha256 = std::string("other");
  EXPECT_TRUE(digests.insert(SpecDigest(spec)).second);
}

// An angle that is not given is not one of 0.
TEST(SpecDigest, WhatIsNotGivenIsNotZero) {
  JobSpec spec;
  spec.options.crease_angle = 0.0;
  EXPECT_NE(SpecDigest(spec), SpecDigest(JobSpec()));
}

TEST(SpecDigest, WhatDoesNotChangeTheSamplesDoesNotChangeIt) {
  JobSpec spec;
  spec.owner = std::string("a");
  spec.request_id = std::string("b");
  spec.labels = {{"c", "d"}};
  spec.origin = Eigen::Vector3d(1, 2, 3);
  spec.options.thread_count = 8;
  spec.options.time_limit_seconds = 5.0;
  spec.ends_with_caller = true;
  EXPECT_EQ(SpecDigest(spec), SpecDigest(JobSpec()));
}

TEST(SpecDigest, NoFieldForgesAnother) {
  JobSpec a;
  a.options.density.attribute = std::string("x\nmeasure:1=1");
  JobSpec b;
  b.options.density.attribute = std::string("x");
  b.options.density.measure = CurvatureMeasure::kMean;
  EXPECT_NE(SpecDigest(a), SpecDigest(b));
}

}  // namespace
}  // namespace ccst::server
