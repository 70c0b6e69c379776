// What a client makes of a server that lies, over a real connection: it ends in words, and what it
// keeps stays within what it asked for.
#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include "client/lib/client.h"
#include "core/base/sha256.h"
#include "proto/convert/names.h"
#include "tests/support/shapes.h"

namespace ccst {
namespace {

using ::testing::HasSubstr;

constexpr int kJobSamples = 100;
// What an endless stream is cut off at, so that a client that takes all of it fails rather than
// hangs.
constexpr int kEndless = 2000;

template <typename Message>
using WriterOf = grpc::ServerWriter<Message>;

// Says what each test wants it to say.
class LyingSampling : public v1::SamplingService::Service {
 public:
  grpc::Status Sample(grpc::ServerContext*, const v1::SampleRequest*,
                      WriterOf<v1::SampleResponse>* writer) override {
    return SendAll(*writer, sample);
  }
  grpc::Status GetJob(grpc::ServerContext*, const v1::GetJobRequest*,
                      v1::GetJobResponse* response) override {
    *response->mutable_job() = job;
    return grpc::Status::OK;
  }
  grpc::Status CreateJob(grpc::ServerContext*, const v1::CreateJobRequest*,
                         v1::CreateJobResponse* response) override {
    *response->mutable_job() = job;
    return grpc::Status::OK;
  }
  grpc::Status ReadSamples(grpc::ServerContext*, const v1::ReadSamplesRequest*,
                           WriterOf<v1::ReadSamplesResponse>* writer) override {
    return SendAll(*writer, read_samples);
  }
  grpc::Status ReadSampleMesh(grpc::ServerContext*, const v1::ReadSampleMeshRequest*,
                              WriterOf<v1::ReadSampleMeshResponse>* writer) override {
    return SendAll(*writer, read_mesh);
  }
  grpc::Status ListJobs(grpc::ServerContext*, const v1::ListJobsRequest*,
                        v1::ListJobsResponse* response) override {
    *response = jobs(++pages);
    return grpc::Status::OK;
  }

  // Message `i` of a stream; kEndless of them are sent unless the client goes away.
  std::function<v1::SampleResponse(int)> sample;
  std::function<v1::ReadSamplesResponse(int)> read_samples;
  std::function<v1::ReadSampleMeshResponse(int)> read_mesh;
  std::function<v1::ListJobsResponse(int)> jobs;
  v1::Job job;
  std::atomic<int> sent = 0;
  std::atomic<int> pages = 0;

 private:
  template <typename Message>
  grpc::Status SendAll(WriterOf<Message>& writer, const std::function<Message(int)>& message) {
    int i = 0;
    while (i < kEndless && writer.Write(message(i))) ++i;
    sent = i;
    return grpc::Status::OK;
  }
};

class LyingMeshes : public v1::MeshService::Service {
 public:
  grpc::Status FindMissingMeshes(grpc::ServerContext*, const v1::FindMissingMeshesRequest*,
                                 v1::FindMissingMeshesResponse*) override {
    return grpc::Status::OK;
  }
  grpc::Status GetMesh(grpc::ServerContext*, const v1::GetMeshRequest*,
                       v1::GetMeshResponse* response) override {
    *response->mutable_mesh() = mesh;
    return grpc::Status::OK;
  }
  grpc::Status DownloadMesh(grpc::ServerContext*, const v1::DownloadMeshRequest*,
                            WriterOf<v1::DownloadMeshResponse>* writer) override {
    v1::DownloadMeshResponse message;
    message.mutable_chunk()->set_data(std::string(1 << 16, 'x'));
    for (sent = 0; sent < kEndless && writer->Write(message); ++sent) {
      message.mutable_chunk()->set_offset_bytes((sent + 1) * (std::int64_t{1} << 16));
    }
    return grpc::Status::OK;
  }
  grpc::Status ListMeshes(grpc::ServerContext*, const v1::ListMeshesRequest*,
                          v1::ListMeshesResponse* response) override {
    *response = meshes;
    return grpc::Status::OK;
  }

  v1::Mesh mesh;
  v1::ListMeshesResponse meshes;
  std::atomic<int> sent = 0;
};

// Samples from `start` on; attributes of so many components.
v1::SampleChunk Samples(std::int64_t start, int count, int components = 0) {
  v1::SampleChunk chunk;
  chunk.set_start_index(start);
  for (int i = 0; i < count; ++i) {
    chunk.add_face_indices(0);
    for (int k = 0; k < 2; ++k) chunk.add_barycentrics(0.25);
    for (int k = 0; k < 3; ++k) chunk.add_positions(0.0F);
    for (int k = 0; k < 3; ++k) chunk.add_normals(1.0F);
  }
  if (components > 0) {
    v1::SampleAttribute& attribute = *chunk.add_attributes();
    attribute.set_name("a");
    attribute.set_component_count(components);
    attribute.mutable_values()->Resize(components * count, 0.5F);
  }
  return chunk;
}

v1::SampleMeshChunk Triangles(std::int64_t start, int count) {
  v1::SampleMeshChunk chunk;
  chunk.set_start_index(start);
  chunk.mutable_vertex_indices()->Resize(3 * count, 0);
  return chunk;
}

class LyingServer : public ::testing::Test {
 protected:
  LyingServer() {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&sampling_);
    builder.RegisterService(&meshes_);
    server_ = builder.BuildAndStart();
    client_.emplace(*Client::Connect({.address = "127.0.0.1:" + std::to_string(port)}));
    job_.mesh = shapes::Icosphere(0);
    job_.draco = std::string(2 << 20, 'x');
    job_.options.sample_count = kJobSamples;
    sampling_.job.set_name("jobs/7");
    sampling_.job.set_state(v1::Job::STATE_SUCCEEDED);
    sampling_.job.mutable_effective_options()->set_sample_count(kJobSamples);
    sampling_.job.mutable_result()->set_sample_count(kJobSamples);
    sampling_.read_samples = [](int i) {
      v1::ReadSamplesResponse message;
      *message.mutable_samples() = Samples(i * kJobSamples, kJobSamples);
      return message;
    };
    meshes_.mesh.set_name(MeshName(Sha256Of("right")));
    meshes_.mesh.mutable_digest()->set_size_bytes(5);
  }
  ~LyingServer() override { server_->Shutdown(); }

  // Of a call that gave up early and said why.
  static void ExpectBroken(const absl::Status& status, const std::string& words, int sent) {
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(words));
    // What was under way when the client gave up has been sent, and no more.
    EXPECT_LT(sent, kEndless);
  }

  LyingSampling sampling_;
  LyingMeshes meshes_;
  std::unique_ptr<grpc::Server> server_;
  std::optional<Client> client_;
  SampleJob job_;
};

TEST_F(LyingServer, SamplesWithoutEndAreRefused) {
  sampling_.sample = [](int i) {
    v1::SampleResponse message;
    *message.mutable_samples() = Samples(i * 10'000, 10'000);
    return message;
  };
  const absl::Status status = client_->Sample(job_).status();
  server_->Shutdown();
  ExpectBroken(status, "more than the 100 samples", sampling_.sent);
}

TEST_F(LyingServer, TrianglesWithoutEndAreRefused) {
  sampling_.sample = [](int i) {
    v1::SampleResponse message;
    if (i == 0) {
      *message.mutable_samples() = Samples(0, kJobSamples);
    } else {
      *message.mutable_sample_mesh() = Triangles((i - 1) * 50'000, 50'000);
    }
    return message;
  };
  const absl::Status status = client_->Sample(job_).status();
  server_->Shutdown();
  ExpectBroken(status, "triangles that there can be", sampling_.sent);
}

TEST_F(LyingServer, AttributesThatTheMeshDoesNotHaveAreRefused) {
  sampling_.sample = [](int) {
    v1::SampleResponse message;
    *message.mutable_samples() = Samples(0, kJobSamples, 4);
    return message;
  };
  const absl::Status status = client_->Sample(job_).status();
  server_->Shutdown();
  ExpectBroken(status, "values of attributes", sampling_.sent);
}

TEST_F(LyingServer, AttributesWhoseNamesDoNotFitFilesAreRefused) {
  job_.mesh.attributes.push_back({.name = "a", .components = 4});
  for (const char* name : {"", "a\nproperty float b", "\x1b[2J", "\xc3\xb6"}) {
    sampling_.sample = [name](int) {
      v1::SampleResponse message;
      *message.mutable_samples() = Samples(0, kJobSamples, 4);
      message.mutable_samples()->mutable_attributes(0)->set_name(name);
      return message;
    };
    const absl::Status status = client_->Sample(job_).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << name;
    EXPECT_THAT(std::string(status.message()), HasSubstr("no proper name")) << name;
  }
}

TEST_F(LyingServer, AttributesOfTheMeshAreTaken) {
  job_.mesh.attributes.push_back({.name = "a", .components = 4});
  sampling_.sample = [](int i) {
    v1::SampleResponse message;
    if (i == 0) *message.mutable_samples() = Samples(0, kJobSamples, 4);
    // Enough of it: the job never ends.
    if (i == 1) *message.mutable_samples() = Samples(kJobSamples, 1, 4);
    return message;
  };
  EXPECT_THAT(std::string(client_->Sample(job_).status().message()),
              HasSubstr("more than the 100 samples"));
}

TEST_F(LyingServer, SamplesBeyondThoseAnnouncedAreRefused) {
  const absl::Status status = client_->FetchJob("jobs/7").status();
  server_->Shutdown();
  ExpectBroken(status, "more than the 100 samples", sampling_.sent);
}

TEST_F(LyingServer, TrianglesBeyondThoseAnnouncedAreRefused) {
  sampling_.job.mutable_result()->set_sample_mesh_face_count(10);
  sampling_.read_samples = [](int i) {
    v1::ReadSamplesResponse message;
    if (i == 0) *message.mutable_samples() = Samples(0, kJobSamples);
    if (i > 0) *message.mutable_samples() = Samples(kJobSamples, 0);
    return message;
  };
  sampling_.read_mesh = [](int i) {
    v1::ReadSampleMeshResponse message;
    *message.mutable_sample_mesh() = Triangles(i * 50'000, 50'000);
    return message;
  };
  const absl::Status status = client_->FetchJob("jobs/7").status();
  server_->Shutdown();
  ExpectBroken(status, "more than the 10 triangles", sampling_.sent);
}

TEST_F(LyingServer, AnnouncementsThatNoJobCanMakeAreRefused) {
  v1::SamplingResult& result = *sampling_.job.mutable_result();
  result.set_sample_mesh_face_count(std::int64_t{1} << 40);
  ExpectBroken(client_->FetchJob("jobs/7").status(), "of only 100 samples", 0);
  result.set_sample_count(std::int64_t{1} << 40);
  ExpectBroken(client_->FetchJob("jobs/7").status(), "asked for 100", 0);
  sampling_.job.mutable_effective_options()->set_sample_count(std::int64_t{1} << 40);
  ExpectBroken(client_->FetchJob("jobs/7").status(), "samples announced", 0);
  sampling_.job.set_name("jobs/8");
  ExpectBroken(client_->FetchJob("jobs/7").status(), "another job", 0);
}

TEST_F(LyingServer, BytesOfAMeshBeyondItsSizeAreRefused) {
  const absl::Status status = client_->DownloadMesh(MeshName(Sha256Of("right"))).status();
  server_->Shutdown();
  ExpectBroken(status, "more than the 5 bytes", meshes_.sent);
}

TEST_F(LyingServer, MeshTooLargeToDownloadIsRefused) {
  meshes_.mesh.mutable_digest()->set_size_bytes(std::int64_t{1} << 40);
  const absl::Status status = client_->DownloadMesh(MeshName(Sha256Of("right"))).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  meshes_.mesh.mutable_digest()->set_size_bytes(-1);
  ExpectBroken(client_->DownloadMesh(MeshName(Sha256Of("right"))).status(), "another mesh", 0);
}

TEST_F(LyingServer, ListThatLeadsToItselfIsRefused) {
  sampling_.jobs = [](int) {
    v1::ListJobsResponse page;
    page.add_jobs()->set_name("jobs/7");
    page.set_next_page_token("again");
    return page;
  };
  const absl::Status status = client_->ListJobs().status();
  ExpectBroken(status, "leads to itself", 0);
  EXPECT_EQ(sampling_.pages, 2);
}

TEST_F(LyingServer, ListWithoutEndIsRefused) {
  sampling_.jobs = [](int page_number) {
    v1::ListJobsResponse page;
    page.add_jobs()->set_display_name(std::string(3 << 20, 'x'));
    page.set_next_page_token(std::to_string(page_number));
    return page;
  };
  const absl::Status status = client_->ListJobs().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("does not end"));
  EXPECT_LT(sampling_.pages, 100);
}

TEST_F(LyingServer, PageOfMoreThanAskedForIsRefused) {
  for (int i = 0; i < 1001; ++i) meshes_.meshes.add_meshes();
  ExpectBroken(client_->ListMeshes().status(), "a page of 1001 records", 0);
}

TEST_F(LyingServer, JobsWithoutAProperNameAreRefused) {
  for (const char* name : {"", "jobs", "meshes/1", "jobs/\x1b[2J", "jobs/a b", "jobs/a\nb"}) {
    sampling_.job.set_name(name);
    ExpectBroken(client_->CreateJob(job_).status(), "no name", 0);
  }
}

}  // namespace
}  // namespace ccst
