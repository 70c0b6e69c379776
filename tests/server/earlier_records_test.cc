// A store of version 4 of the schema, whose rows carry messages of the API, is taken up by a
// manager of today. The rows are built here by the rules of then.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ccst/v1/sampling_service.pb.h"
#include "core/base/limit_error.h"
#include "core/base/sha256.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/util/delimited_message_util.h"
#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/status.h"
#include "server/formats/mesh_facts.h"
#include "server/store/job_rows.h"
#include "server/store/mesh_table.h"
#include "server/store/record_bytes.h"
#include "server/store/schema.h"
#include "tests/server/job_manager_fixture.h"

namespace ccst::server {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

constexpr int kAlternations = 3;

v1::CreateJobRequest Request(std::uint64_t seed) {
  SamplingOptions options;
  options.sample_count = 10;
  options.seed = seed;
  options.time_limit_seconds = 3600.0;
  v1::CreateJobRequest request;
  *request.mutable_spec()->mutable_options() = ccst::ToProto(options);
  return request;
}

std::string History() {
  std::string bytes;
  google::protobuf::io::StringOutputStream out(&bytes);
  for (int i = 1; i <= kAlternations; ++i) {
    AlternationReport report;
    report.alternation = i;
    report.energy = 1.0 / i;
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(
        ccst::ToProto(report, Phase::kRelaxing), &out);
  }
  return bytes;
}

v1::Job Succeeded() {
  v1::Job job;
  v1::SamplingResult& result = *job.mutable_result();
  result.set_termination_reason(v1::TERMINATION_REASON_CONVERGED);
  result.set_sample_count(10);
  result.set_capacity_cv(0.01);
  job.mutable_progress()->set_phase(v1::JOB_PHASE_FINALIZING);
  return job;
}

class EarlierRecords : public JobManagerTest {
 protected:
  void SetUp() override {
    {
      const auto store = *OpenEmbeddedStore(Data());
      mesh_ = *PutWhole(store->blobs(), "mesh");
      samples_ = *PutWhole(store->blobs(), "samples");
    }
    for (const char* name : {"", "-wal", "-shm"}) std::filesystem::remove(Records() + name);
    database_ = *Database::Open(Records());
    ASSERT_TRUE(MigrateSchema(*database_, SchemaMigrations().first(4)).ok());
  }

  std::string Data() const { return folder_.Path("data"); }
  std::string Records() const { return Data() + "/records.sqlite"; }

  JobRecord Waiting(const std::string& id, const v1::CreateJobRequest& request) const {
    JobRecord job;
    job.id = id;
    job.display_name = "job " + id;
    job.labels = {{"team", "blue"}};
    job.mesh_sha256 = mesh_;
    job.spec_digest = "of " + id;
    job.definition = request.SerializeAsString();
    job.create_time = now_;
    return job;
  }
  JobRecord Ended(const std::string& id, JobState state, const v1::Job& outcome) const {
    JobRecord job = Waiting(id, Request(0));
    job.state = state;
    job.start_time = now_;
    job.end_time = now_;
    job.expire_time = now_ + absl::Hours(1);
    job.outcome = outcome.SerializeAsString();
    if (state == JobState::kSucceeded) job.samples_sha256 = samples_;
    return job;
  }

  // As version 4 wrote it.
  void Write(const JobRecord& job, const std::string& history = "") {
    const std::string history_sha256 = history.empty() ? "" : Sha256Of(history);
    ASSERT_TRUE(database_->Once("INSERT OR IGNORE INTO histories SELECT ?1, ?2 WHERE ?1 <> ''")
                    .Bind(history_sha256)
                    .Bind(Bytes{history})
                    .Run()
                    .ok());
    const auto length = static_cast<std::int64_t>(history.size());
    const char* const state = job.state == JobState::kQueued      ? "queued"
                              : job.state == JobState::kSucceeded ? "succeeded"
                                                                  : "failed";
    ASSERT_TRUE(
        database_
            ->Once("INSERT INTO jobs (id, owner, request_id, display_name, mesh_sha256, "
                   "texture_sha256, spec_digest, definition, state, create_time, start_time, "
                   "end_time, expire_time, outcome, samples_sha256, reusable, cached, "
                   "definition_sha256, request_sum, end_sum, history_sha256, record_bytes) "
                   "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
            .Bind(job.id)
            .Bind(job.owner)
            .Bind(job.request_id)
            .Bind(job.display_name)
            .Bind(job.mesh_sha256)
            .Bind(job.texture_sha256)
            .Bind(job.spec_digest)
            .Bind(Bytes{job.definition})
            .Bind(state)
            .Bind(job.create_time)
            .Bind(job.start_time)
            .Bind(job.end_time)
            .Bind(job.expire_time)
            .Bind(Bytes{job.outcome})
            .Bind(job.samples_sha256)
            .Bind(job.reusable)
            .Bind(job.cached)
            .Bind(Sha256Of(job.definition))
            .Bind(SumOfRequest(job))
            .Bind(SumOfEnd(job, history_sha256))
            .Bind(history_sha256)
            .Bind(BytesOf(job) + length)
            .Run()
            .ok());
    for (const auto& [name, value] : job.labels) {
      ASSERT_TRUE(database_->Once("INSERT INTO job_labels VALUES (?, ?, ?, ?, ?, ?)")
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
  void Change(const std::string& sql) { ASSERT_TRUE(database_->RunScript(sql).ok()); }

  // Takes the store up, as today's program does.
  void TakeUp(SampleFunction sample) {
    database_ = nullptr;
    Start(std::move(sample));
  }
  std::int64_t CountOf(const std::string& table) {
    const auto database = *Database::Open(Records());
    Statement statement = database->Once("SELECT count(*) FROM " + table);
    EXPECT_TRUE(statement.Next());
    return statement.Int(0);
  }

  std::string mesh_;
  std::string samples_;
  std::unique_ptr<Database> database_;
};

TEST_F(EarlierRecords, WhatWaitedRunsAsItWasAskedFor) {
  Write(Waiting("a", Request(77)));
  std::uint64_t seed = 0;
  TakeUp(
      [&seed](const TriangleMesh& mesh, const SamplingOptions& options, const RunControl& control) {
        seed = options.seed;
        return QuickSampler()(mesh, options, control);
      });
  EXPECT_EQ(Finish("a").state, JobState::kSucceeded);
  EXPECT_EQ(seed, 77u);
  const auto job = *jobs_->Find("", "a");
  EXPECT_EQ(job->spec().options.sample_count, 10);
  EXPECT_EQ(job->spec().display_name, "job a");
  EXPECT_THAT(job->spec().labels, ElementsAre(testing::Pair("team", "blue")));
}

TEST_F(EarlierRecords, JobOfAGoneCallerIsCancelled) {
  v1::CreateJobRequest request = Request(0);
  (*request.mutable_labels())["ends-with-caller"] = "";
  Write(Waiting("a", request));
  TakeUp(QuickSampler());
  EXPECT_EQ(Finish("a").state, JobState::kCancelled);
}

TEST_F(EarlierRecords, EndedJobKeepsResultReportsAndSamples) {
  Write(Ended("a", JobState::kSucceeded, Succeeded()), History());
  TakeUp(QuickSampler());
  const auto job = *jobs_->Find("", "a");
  const JobView view = job->View();
  EXPECT_EQ(view.state, JobState::kSucceeded);
  ASSERT_NE(view.result, nullptr);
  EXPECT_EQ(view.result->sample_count, 10);
  EXPECT_EQ(view.result->run.capacity_cv, 0.01);
  EXPECT_EQ(view.phase, Phase::kFinalizing);
  EXPECT_EQ(view.samples_blob, samples_);
  ASSERT_THAT(job->Reports(), SizeIs(kAlternations));
  EXPECT_EQ(job->Reports()[2].energy, 1.0 / 3);
  EXPECT_TRUE(store_->blobs().Contains(samples_));
}

TEST_F(EarlierRecords, FailedJobKeepsItsError) {
  v1::Job outcome;
  *outcome.mutable_error() = ccst::ToProto(OverLimit({"max_faces", 5, 7}, "the mesh has 7 faces"));
  Write(Ended("a", JobState::kFailed, outcome));
  TakeUp(QuickSampler());
  const absl::Status error = (*jobs_->Find("", "a"))->View().error;
  EXPECT_EQ(error.message(), "the mesh has 7 faces");
  EXPECT_EQ(GetErrorReason(error), ErrorReason::kLimitExceeded);
  EXPECT_EQ(GetPassedLimit(error)->requested, 7);
}

TEST_F(EarlierRecords, SameRequestIdGivesTheSameJob) {
  JobRecord record = Waiting("a", Request(5));
  record.request_id = "mine";
  Write(record);
  TakeUp(QuickSampler());
  JobSpec spec = Spec(5);
  spec.request_id = "mine";
  spec.options.time_limit_seconds = 3600.0;
  EXPECT_EQ(Create(spec)->id(), "a");
  spec.options.seed = 6;
  EXPECT_EQ(jobs_->Create(spec).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(EarlierRecords, SharedHistoryStaysOneAndIsCountedForEach) {
  Write(Ended("a", JobState::kSucceeded, Succeeded()), History());
  Write(Ended("b", JobState::kSucceeded, Succeeded()), History());
  TakeUp(QuickSampler());
  EXPECT_EQ(CountOf("histories"), 1);
  EXPECT_THAT((*jobs_->Find("", "b"))->Reports(), SizeIs(kAlternations));
  const JobRecord record = **store_->GetJob("a");
  const auto history = static_cast<std::int64_t>(store_->GetHistory("a")->size());
  EXPECT_EQ(*store_->RecordBytes(""), 2 * (BytesOf(record) + history));
  ASSERT_TRUE(jobs_->Delete("", "a").ok());
  ASSERT_TRUE(jobs_->Delete("", "b").ok());
  EXPECT_EQ(*store_->AllRecordBytes(), 0);
  EXPECT_EQ(CountOf("histories"), 0);
}

TEST_F(EarlierRecords, WaitingJobKeepsTheRoomOfItsEnd) {
  JobRecord record = Waiting("a", Request(0));
  Write(record);
  Change("UPDATE jobs SET record_bytes = record_bytes + 5000");
  database_ = nullptr;
  const auto store = *OpenEmbeddedStore(Data());
  EXPECT_EQ(*store->RecordBytes(""), BytesOf(**store->GetJob("a")) + 5000);
}

TEST_F(EarlierRecords, DamagedRowsAreSeenAndInNobodysWay) {
  for (const char* id : {"a", "b", "c", "d"}) {
    Write(Ended(id, JobState::kSucceeded, Succeeded()), History());
  }
  v1::CreateJobRequest unreadable;  // Asks for no samples.
  Write(Waiting("e", unreadable));
  Write(Waiting("f", Request(0)));
  Change(
      "UPDATE jobs SET display_name = 'other' WHERE id = 'a';"
      "UPDATE jobs SET definition = CAST('x' AS BLOB) WHERE id = 'b';"
      "UPDATE jobs SET outcome = CAST('x' AS BLOB) WHERE id = 'c';");
  TakeUp(QuickSampler());
  for (const char* id : {"a", "b", "c"}) {
    EXPECT_EQ(jobs_->Find("", id).status().code(), absl::StatusCode::kDataLoss) << id;
  }
  EXPECT_EQ(Finish("f").state, JobState::kSucceeded);
  EXPECT_EQ((*jobs_->Find("", "d"))->View().state, JobState::kSucceeded);
  const auto page = *jobs_->List({}, 10, "");
  ASSERT_THAT(page.records, SizeIs(6));
  for (const JobSummary& job : page.records) {
    const bool is_whole = job.id == "d" || job.id == "f";
    EXPECT_EQ(job.view.state, is_whole ? JobState::kSucceeded : JobState::kFailed) << job.id;
  }
}

TEST_F(EarlierRecords, DamagedHistoryKeepsNobodyFromTheResult) {
  Write(Ended("a", JobState::kSucceeded, Succeeded()), History());
  Write(Ended("b", JobState::kSucceeded, Succeeded()), "no history");
  Change("UPDATE histories SET history = CAST('x' AS BLOB) WHERE sha256 = '" + Sha256Of(History()) +
         "'");
  TakeUp(QuickSampler());
  for (const char* id : {"a", "b"}) {
    const auto job = *jobs_->Find("", id);
    EXPECT_EQ(job->View().state, JobState::kSucceeded);
    EXPECT_EQ(job->history_status().code(), absl::StatusCode::kDataLoss);
  }
}

TEST_F(EarlierRecords, FactsOfMeshesAreRead) {
  MeshRecord mesh;
  mesh.owner = "ann";
  mesh.sha256 = mesh_;
  mesh.size_bytes = 4;
  mesh.display_name = "bunny";
  mesh.create_time = now_;
  mesh.expire_time = now_ + absl::Hours(1);
  v1::Mesh facts;
  facts.set_face_count(12);
  mesh.facts = facts.SerializeAsString();
  ASSERT_TRUE(MeshTable(*database_).Put(mesh).ok());
  database_ = nullptr;
  const auto store = *OpenEmbeddedStore(Data());
  const MeshRecord read = **store->GetMesh("ann", mesh_);
  EXPECT_FALSE(read.damaged);
  EXPECT_EQ(DecodeFacts(read.facts)->file_faces, 12);
  EXPECT_EQ(*store->RecordBytes("ann"), BytesOf(read));
}

}  // namespace
}  // namespace ccst::server
