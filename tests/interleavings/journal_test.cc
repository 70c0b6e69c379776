// The journal finds what contradicts every order of the calls, and nothing else.
#include "tests/interleavings/journal.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::interleavings {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kAnn = 0;
constexpr int kBob = 1;
constexpr char kMesh[] = "meshes/m";

absl::Status Refused(absl::StatusCode code, ErrorReason reason) {
  return MakeError(code, reason, "no");
}
const absl::Status kNotFound = Refused(absl::StatusCode::kNotFound, ErrorReason::kNotFound);

class JournalTest : public testing::Test {
 protected:
  static v1::CreateJobRequest Request(const std::string& id = "") {
    v1::CreateJobRequest request;
    request.mutable_spec()->set_mesh(kMesh);
    request.set_request_id(id);
    return request;
  }
  static v1::Job Job(const std::string& name, v1::Job::State state = v1::Job::STATE_QUEUED,
                     const std::string& digest = "digest") {
    v1::Job job;
    job.set_name(name);
    job.set_mesh(kMesh);
    job.set_state(state);
    if (state == v1::Job::STATE_SUCCEEDED) {
      job.mutable_result()->mutable_samples_digest()->set_sha256(digest);
    }
    return job;
  }
  void Create(const std::string& name, const std::string& request_id = "") {
    const v1::CreateJobRequest request = Request(request_id);
    journal_.Created(kAnn, request, journal_.BeginCreate(kAnn, request), Job(name));
  }
  void Delete(const std::string& name) {
    journal_.Deleted(kAnn, name, journal_.BeginDelete(name), absl::OkStatus());
  }
  void Upload() {
    journal_.Uploaded(kAnn, kMesh, journal_.BeginUpload(kAnn, kMesh), absl::OkStatus());
  }

  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  Journal journal_{[this] { return now_; }, absl::Seconds(100)};
};

TEST_F(JournalTest, JobThatNobodyDeletedMustBeFound) {
  Create("jobs/1");
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), kNotFound);
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("nobody deleted it")));
}

TEST_F(JournalTest, JobMayBeMissingFromTheBeginOfItsDeletion) {
  Create("jobs/1");
  const Moment deletes = journal_.BeginDelete("jobs/1");
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), kNotFound);
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), Job("jobs/1"));
  journal_.Deleted(kAnn, "jobs/1", deletes, absl::OkStatus());
  EXPECT_THAT(journal_.faults(), IsEmpty());
}

TEST_F(JournalTest, DeletedJobMustNotBeFound) {
  Create("jobs/1");
  const Moment before = journal_.Begin();
  Delete("jobs/1");
  journal_.Saw(kAnn, "jobs/1", before, Job("jobs/1"));
  EXPECT_THAT(journal_.faults(), IsEmpty());
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), Job("jobs/1"));
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("finds it deleted")));
}

TEST_F(JournalTest, RefusedDeletionDeletesNothing) {
  Create("jobs/1");
  journal_.Deleted(kAnn, "jobs/1", journal_.BeginDelete("jobs/1"),
                   Refused(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded));
  EXPECT_THAT(journal_.faults(), IsEmpty());
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), kNotFound);
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("nobody deleted it")));
}

TEST_F(JournalTest, JobMayExpireAfterItsRetention) {
  Create("jobs/1");
  now_ += absl::Seconds(100);
  journal_.Listed(kAnn, journal_.Begin(), std::vector<v1::Job>());
  EXPECT_THAT(journal_.faults(), IsEmpty());
}

TEST_F(JournalTest, AcknowledgedJobMustBeListed) {
  Create("jobs/1");
  Create("jobs/2");
  journal_.Listed(kBob, journal_.Begin(), std::vector<v1::Job>());
  journal_.Listed(kAnn, journal_.Begin(), std::vector<v1::Job>{Job("jobs/2")});
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("jobs/1: is not listed")));
}

TEST_F(JournalTest, JobAcknowledgedDuringAListMayBeMissingFromIt) {
  const Moment begin = journal_.Begin();
  Create("jobs/1");
  journal_.Listed(kAnn, begin, std::vector<v1::Job>());
  EXPECT_THAT(journal_.faults(), IsEmpty());
}

TEST_F(JournalTest, JobListedTwiceOrToOthersIsAFault) {
  Create("jobs/1");
  journal_.Listed(kAnn, journal_.Begin(), std::vector<v1::Job>{Job("jobs/1"), Job("jobs/1")});
  journal_.Listed(kBob, journal_.Begin(), std::vector<v1::Job>{Job("jobs/1")});
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("twice"), HasSubstr("another owner")));
}

TEST_F(JournalTest, EqualRequestsMustGiveTheSameJob) {
  Create("jobs/1", "request");
  Create("jobs/1", "request");
  Create("jobs/2", "another");
  EXPECT_THAT(journal_.faults(), IsEmpty());
  Create("jobs/3", "request");
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("are both of request_id request")));
}

TEST_F(JournalTest, RequestIdIsFreeAgainWhenItsJobIsDeleted) {
  Create("jobs/1", "request");
  Delete("jobs/1");
  Create("jobs/2", "request");
  EXPECT_THAT(journal_.faults(), IsEmpty());
  Create("jobs/1", "request");
  EXPECT_THAT(journal_.faults(), testing::Contains(HasSubstr("after it had been deleted")));
}

TEST_F(JournalTest, RequestIdOfAnotherSpecIsRefused) {
  Create("jobs/1", "request");
  v1::CreateJobRequest other = Request("request");
  other.mutable_spec()->mutable_options()->set_sample_count(5);
  const absl::Status refused =
      Refused(absl::StatusCode::kInvalidArgument, ErrorReason::kRequestInvalid);
  journal_.Created(kAnn, other, journal_.BeginCreate(kAnn, other), refused);
  EXPECT_THAT(journal_.faults(), IsEmpty());
  journal_.Created(kAnn, other, journal_.BeginCreate(kAnn, other), Job("jobs/1"));
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("and another spec")));
  const v1::CreateJobRequest alone = Request("alone");
  journal_.Created(kAnn, alone, journal_.BeginCreate(kAnn, alone), refused);
  EXPECT_THAT(journal_.faults(), testing::Contains(HasSubstr("REQUEST_INVALID")));
}

TEST_F(JournalTest, CreateJobMustNotBeRefused) {
  journal_.Created(kAnn, Request("request"), journal_.Begin(),
                   Refused(absl::StatusCode::kUnavailable, ErrorReason::kDraining));
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("DRAINING")));
}

TEST_F(JournalTest, StoredMeshMustNotBeMissing) {
  const absl::Status missing =
      Refused(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshMissing);
  journal_.Created(kAnn, Request(), journal_.Begin(), missing);
  EXPECT_THAT(journal_.faults(), IsEmpty());
  Upload();
  const Moment deletes = journal_.BeginDeleteMesh(kAnn, kMesh);
  journal_.Created(kAnn, Request(), journal_.Begin(), missing);
  EXPECT_THAT(journal_.faults(), IsEmpty());
  journal_.DeletedMesh(kAnn, kMesh, deletes,
                       Refused(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshInUse));
  journal_.Created(kAnn, Request(), journal_.Begin(), missing);
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("MESH_MISSING")));
}

TEST_F(JournalTest, DownloadedMeshIsWhatWasUploaded) {
  Upload();
  journal_.Downloaded(kAnn, kMesh, "right", journal_.Begin(), std::string("right"));
  journal_.Downloaded(kAnn, kMesh, "right", journal_.Begin(), std::string("wrong"));
  journal_.DeletedMesh(kAnn, kMesh, journal_.BeginDeleteMesh(kAnn, kMesh), absl::OkStatus());
  journal_.Downloaded(kAnn, kMesh, "right", journal_.Begin(), std::string("right"));
  EXPECT_THAT(journal_.faults(),
              ElementsAre(HasSubstr("other bytes"), HasSubstr("finds it deleted")));
}

TEST_F(JournalTest, SucceededJobMustBeReadableWithTheDigestOfItsSpec) {
  Create("jobs/1");
  journal_.Read(kAnn, "jobs/1", journal_.Begin(),
                Refused(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded));
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), Job("jobs/1", v1::Job::STATE_SUCCEEDED));
  journal_.Read(kAnn, "jobs/1", journal_.Begin(), std::string("digest"));
  EXPECT_THAT(journal_.faults(), IsEmpty());
  journal_.Read(kAnn, "jobs/1", journal_.Begin(),
                Refused(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded));
  journal_.Read(kAnn, "jobs/1", journal_.Begin(), kNotFound);
  journal_.Read(kAnn, "jobs/1", journal_.Begin(), std::string("another"));
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("JOB_NOT_ENDED"), HasSubstr("NOT_FOUND"),
                                             HasSubstr("has samples another")));
}

TEST_F(JournalTest, EndsNeverChange) {
  Create("jobs/1");
  journal_.Saw(kAnn, "jobs/1", journal_.BeginCancel("jobs/1"),
               Job("jobs/1", v1::Job::STATE_CANCELLED));
  EXPECT_THAT(journal_.faults(), IsEmpty());
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), Job("jobs/1", v1::Job::STATE_SUCCEEDED));
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("was STATE_CANCELLED")));
}

TEST_F(JournalTest, NobodyMayCancelOrFailAJobButItsCallers) {
  Create("jobs/1");
  Create("jobs/2");
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), Job("jobs/1", v1::Job::STATE_CANCELLED));
  journal_.Saw(kAnn, "jobs/2", journal_.Begin(), Job("jobs/2", v1::Job::STATE_FAILED));
  EXPECT_THAT(journal_.faults(),
              ElementsAre(HasSubstr("nobody asked for that"), HasSubstr("FAILED")));
}

TEST_F(JournalTest, JobExpiresFromWhenTheCallBeganThatMayHaveMadeIt) {
  const v1::CreateJobRequest request = Request("id");
  const Moment slow = journal_.BeginCreate(kAnn, request);
  now_ += absl::Seconds(30);
  const Moment quick = journal_.BeginCreate(kAnn, request);
  journal_.Created(kAnn, request, quick, Job("jobs/1"));
  now_ += absl::Seconds(75);
  journal_.Saw(kAnn, "jobs/1", journal_.Begin(), kNotFound);
  journal_.Created(kAnn, request, slow, Job("jobs/1"));
  EXPECT_THAT(journal_.faults(), IsEmpty());
  // Whoever comes now made no job that is known already.
  now_ += absl::Seconds(1);
  const Moment later = journal_.BeginCreate(kAnn, request);
  journal_.Created(kAnn, request, later, Job("jobs/2"));
  now_ += absl::Seconds(75);
  journal_.Saw(kAnn, "jobs/2", journal_.Begin(), kNotFound);
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("nobody deleted it")));
}

TEST_F(JournalTest, WatchersGetEveryReport) {
  Create("jobs/1");
  Watched watched = {.end = Job("jobs/1", v1::Job::STATE_SUCCEEDED), .report_count = 3};
  watched.end.mutable_effective_options()->set_method(v1::SAMPLING_METHOD_CCST);
  watched.end.mutable_result()->set_iteration_count(2);
  journal_.SawEnd(kAnn, "jobs/1", journal_.Begin(), watched);
  EXPECT_THAT(journal_.faults(), IsEmpty());
  watched.report_count = 2;
  journal_.SawEnd(kAnn, "jobs/1", journal_.Begin(), watched);
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("2 reports of 3")));
}

TEST_F(JournalTest, WatchersOfWhiteNoiseGetNoReport) {
  Create("jobs/1");
  Watched watched = {.end = Job("jobs/1", v1::Job::STATE_SUCCEEDED), .report_count = 0};
  watched.end.mutable_effective_options()->set_method(v1::SAMPLING_METHOD_WHITE_NOISE);
  journal_.SawEnd(kAnn, "jobs/1", journal_.Begin(), watched);
  EXPECT_THAT(journal_.faults(), IsEmpty());
  watched.report_count = 1;
  journal_.SawEnd(kAnn, "jobs/1", journal_.Begin(), watched);
  EXPECT_THAT(journal_.faults(), ElementsAre(HasSubstr("1 reports of 0")));
}

class RestTest : public testing::Test {
 protected:
  RestTest() {
    v1::Job job;
    job.set_name("jobs/1");
    job.set_mesh(kMesh);
    job.set_state(v1::Job::STATE_SUCCEEDED);
    job.mutable_result()->mutable_samples_digest()->set_sha256("digest");
    jobs_ = {job};
    holdings_ = {.blobs = {{"m", 10}, {"s", 5}}, .counted_bytes = 15};
  }
  std::vector<std::string> Faults() const { return FaultsAtRest(jobs_, {}, holdings_); }

  std::vector<v1::Job> jobs_;
  Holdings holdings_;
};

TEST_F(RestTest, WhatJobsAndMeshesNeedIsRight) { EXPECT_THAT(Faults(), IsEmpty()); }

TEST_F(RestTest, BlobThatNothingNeedsIsAFault) {
  holdings_.blobs["x"] = 1;
  holdings_.counted_bytes = 16;
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("2 blobs are no listed mesh")));
}

TEST_F(RestTest, MissingBlobIsAFault) {
  holdings_ = {.blobs = {{"s", 5}}, .counted_bytes = 5};
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("bytes are gone")));
}

TEST_F(RestTest, BytesThatAreNotThereMustNotBeCounted) {
  holdings_.counted_bytes = 20;
  EXPECT_THAT(Faults(), ElementsAre("20 bytes are counted, 15 are stored"));
}

TEST_F(RestTest, NothingRunsWatchesOrTakesMemory) {
  jobs_[0].set_state(v1::Job::STATE_RUNNING);
  holdings_.memory_bytes = 1;
  holdings_.watchers = 2;
  EXPECT_THAT(Faults(), ElementsAre(HasSubstr("is STATE_RUNNING"), HasSubstr("1 bytes of memory"),
                                    HasSubstr("2 watchers")));
}

}  // namespace
}  // namespace ccst::interleavings
