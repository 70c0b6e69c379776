// What a caller of `Sample` reads.
#include <new>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

using Event = v1::SampleResponse::EventCase;

TEST(SampleStream, EventsComeInTheirOrder) {
  constexpr int kCount = 40'000;
  TestServer server(QuickSampler(5));
  v1::SampleRequest request = Request(kCount);
  request.mutable_inline_mesh()->mutable_origin()->set_x(1e6);
  const Answer answer = Sample(server.sampling(), request);
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  ASSERT_GE(answer.events.size(), 2U);
  EXPECT_TRUE(answer.events.front().has_snapshot());
  const v1::Job& last = answer.events.back().snapshot();
  EXPECT_EQ(last.state(), v1::Job::STATE_SUCCEEDED);
  EXPECT_EQ(last.result().sample_count(), kCount);
  EXPECT_EQ(last.result().samples_digest().sha256(), "digest");
  EXPECT_EQ(last.origin().x(), 1e6);
  EXPECT_EQ(last.name(), answer.events.front().snapshot().name());
  EXPECT_EQ(last.name().rfind("jobs/", 0), 0U);
  int iteration = 0;
  std::int64_t samples = 0;
  std::int64_t triangles = 0;
  for (std::size_t i = 0; i + 1 < answer.events.size(); ++i) {
    const v1::SampleResponse& event = answer.events[i];
    switch (event.event_case()) {
      case Event::kSnapshot:
        EXPECT_EQ(samples, 0) << "a snapshot between samples";
        break;
      case Event::kProgress:
        EXPECT_EQ(event.progress().iteration(), ++iteration);
        EXPECT_EQ(samples, 0) << "progress after samples";
        break;
      case Event::kSamples:
        EXPECT_EQ(event.samples().start_index(), samples);
        EXPECT_LE(event.samples().face_indices_size(), 4096);
        EXPECT_EQ(triangles, 0) << "samples after triangles";
        samples += event.samples().face_indices_size();
        break;
      case Event::kSampleMesh:
        EXPECT_EQ(event.sample_mesh().start_index(), triangles);
        EXPECT_LE(event.sample_mesh().vertex_indices_size(), 3 * 4096);
        EXPECT_EQ(samples, kCount) << "triangles before the last sample";
        triangles += event.sample_mesh().vertex_indices_size() / 3;
        break;
      default:
        FAIL() << "unexpected event " << event.event_case();
    }
  }
  EXPECT_EQ(iteration, 5);
  EXPECT_EQ(samples, kCount);
  EXPECT_EQ(triangles, kCount);
}

TEST(SampleStream, WrongOptionsAreRefusedWithTheirFields) {
  TestServer server(QuickSampler());
  v1::SampleRequest request = Request(1);
  request.mutable_options()->set_relative_tolerance(-1.0);
  const Answer answer = Sample(server.sampling(), request);
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_TRUE(answer.events.empty());
  EXPECT_EQ(answer.reason(), "OPTION_INVALID");
  EXPECT_EQ(answer.details().message(), answer.status.error_message());
  v1::FieldViolations violations;
  ASSERT_TRUE(Unpack(answer.details(), violations));
  EXPECT_EQ(violations.field_violations_size(), 2);
}

TEST(SampleStream, RefusedMeshEndsTheCallWithItsReason) {
  TestServer server([](auto&&...) -> absl::StatusOr<SamplingResult> {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshNotManifold,
                     "edge 1-2 has 3 faces " + std::string(5000, 'x'));
  });
  const Answer answer = Sample(server.sampling(), Request());
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(answer.reason(), "MESH_NOT_MANIFOLD");
  EXPECT_EQ(answer.status.error_message().size(), 1024U);
}

TEST(SampleStream, BrokenRunIsAFailedJobOfACallThatWentWell) {
  TestServer server([](const TriangleMesh&, const SamplingOptions& options,
                       const RunControl&) -> absl::StatusOr<SamplingResult> {
    if (options.seed == 1) throw std::bad_alloc();
    throw std::runtime_error("bug");
  });
  v1::SampleRequest request = Request();
  for (const auto& [seed, code] : {std::pair{1, 8}, {2, 13}}) {
    request.mutable_options()->set_seed(static_cast<std::uint64_t>(seed));
    const Answer answer = Sample(server.sampling(), request);
    EXPECT_TRUE(answer.status.ok());
    EXPECT_EQ(answer.events.back().snapshot().state(), v1::Job::STATE_FAILED);
    EXPECT_EQ(answer.events.back().snapshot().error().code(), code);
  }
}

TEST(SampleStream, WaitingCallersSeeTheirPosition) {
  Gate started;
  Gate go;
  ServerOptions options;
  options.runner = {.max_running_jobs = 1, .max_queued_jobs = 2};
  TestServer server(GatedSampler(started, go), options);
  std::vector<std::unique_ptr<grpc::ClientContext>> contexts;
  std::vector<std::unique_ptr<grpc::ClientReader<v1::SampleResponse>>> readers;
  for (int i = 0; i < 3; ++i) {
    contexts.push_back(std::make_unique<grpc::ClientContext>());
    readers.push_back(server.sampling().Sample(contexts.back().get(), Request()));
    v1::SampleResponse event;
    ASSERT_TRUE(readers.back()->Read(&event));
    if (i == 0) {
      started.Wait();
    } else {
      EXPECT_EQ(event.snapshot().state(), v1::Job::STATE_QUEUED);
      EXPECT_EQ(event.snapshot().queue_position(), i - 1);
    }
  }
  const Answer refused = Sample(server.sampling(), Request());
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.reason(), "QUEUE_FULL");
  v1::RetryAdvice advice;
  ASSERT_TRUE(Unpack(refused.details(), advice));
  EXPECT_GT(advice.retry_delay().seconds(), 0);

  contexts[1]->TryCancel();
  EXPECT_EQ(ReadAll(*readers[1]).status.error_code(), grpc::StatusCode::CANCELLED);
  v1::SampleResponse moved;
  ASSERT_TRUE(readers[2]->Read(&moved));
  EXPECT_EQ(moved.snapshot().queue_position(), 0);
  go.Open();
  EXPECT_TRUE(ReadAll(*readers[0]).status.ok());
  EXPECT_TRUE(ReadAll(*readers[2]).status.ok());
}

TEST(SampleStream, SlowReaderMissesPreviewsButNoProgress) {
  constexpr int kAlternations = 2000;
  constexpr int kCount = 100'000;
  Gate done;
  const SampleFunction quick = QuickSampler(kAlternations);
  TestServer server(
      [&](const TriangleMesh& mesh, const SamplingOptions& options, const RunControl& run) {
        auto result = quick(mesh, options, run);
        done.Open();
        return result;
      });
  v1::SampleRequest request = Request(kCount);
  request.set_preview_sample_count(10'000);
  grpc::ClientContext context;
  const auto reader = server.sampling().Sample(&context, request);
  v1::SampleResponse first;
  ASSERT_TRUE(reader->Read(&first));
  done.Wait();  // The run does not wait for us.
  const Answer answer = ReadAll(*reader);
  ASSERT_TRUE(answer.status.ok());
  int iteration = 0;
  int previews = 0;
  std::int64_t samples = 0;
  for (const v1::SampleResponse& event : answer.events) {
    if (event.has_progress()) {
      EXPECT_EQ(event.progress().iteration(), ++iteration);
    }
    if (event.has_preview()) {
      ++previews;
      EXPECT_EQ(event.preview().positions_size(), 30'000);
    }
    samples += event.samples().face_indices_size();
  }
  EXPECT_EQ(iteration, kAlternations);
  EXPECT_EQ(samples, kCount);
  EXPECT_LT(previews, kAlternations / 2);
}

TEST(SampleStream, ThousandSmallRequestsAreAnswered) {
  TestServer server(QuickSampler());
  for (int i = 0; i < 1000; ++i) {
    const Answer answer = Sample(server.sampling(), Request());
    ASSERT_TRUE(answer.status.ok()) << i << ": " << answer.status.error_message();
    ASSERT_EQ(answer.events.back().snapshot().state(), v1::Job::STATE_SUCCEEDED);
  }
}

}  // namespace
}  // namespace ccst::server
