// Callers that go away: the work stops within 100 ms and the worker is free again.
#include <atomic>
#include <chrono>
#include <optional>

#include <gtest/gtest.h>

#include "core/base/status.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kStopWithin(100);

// A run of which the first only ends by being stopped; later ones are quick.
class StoppableRun {
 public:
  SampleFunction Sampler() {
    return [this, quick = QuickSampler()](const TriangleMesh& mesh, const SamplingOptions& options,
                                          const RunControl& run) -> absl::StatusOr<SamplingResult> {
      if (calls_++ > 0) return quick(mesh, options, run);
      started_.Open();
      Gate never;
      never.WaitOrStop(run.stop);
      stopped_at_ = steady_clock::now();
      stopped_.Open();
      return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "stopped");
    };
  }

  void WaitUntilStarted() { started_.Wait(); }
  steady_clock::time_point WaitUntilStopped() {
    stopped_.Wait();
    return stopped_at_;
  }

 private:
  std::atomic<int> calls_ = 0;
  Gate started_;
  Gate stopped_;
  steady_clock::time_point stopped_at_;
};

ServerOptions OneWorker() {
  ServerOptions options;
  options.runner = {.max_running_jobs = 1, .max_queued_jobs = 1};
  return options;
}

TEST(SampleStop, CancelFreesTheWorkerWithin100Ms) {
  StoppableRun run;
  TestServer server(run.Sampler(), OneWorker());
  grpc::ClientContext context;
  const auto reader = server.sampling().Sample(&context, Request());
  run.WaitUntilStarted();
  const auto cancelled_at = steady_clock::now();
  context.TryCancel();
  EXPECT_LT(run.WaitUntilStopped() - cancelled_at, kStopWithin);
  EXPECT_EQ(ReadAll(*reader).status.error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(Sample(server.sampling(), Request()).status.ok());
}

TEST(SampleStop, PassedDeadlineStopsTheRunWithin100Ms) {
  StoppableRun run;
  TestServer server(run.Sampler(), OneWorker());
  grpc::ClientContext context;
  const auto deadline = std::chrono::system_clock::now() + milliseconds(300);
  const auto steady_deadline = steady_clock::now() + milliseconds(300);
  context.set_deadline(deadline);
  const auto reader = server.sampling().Sample(&context, Request());
  run.WaitUntilStarted();
  EXPECT_LT(run.WaitUntilStopped() - steady_deadline, kStopWithin);
  EXPECT_EQ(ReadAll(*reader).status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_TRUE(Sample(server.sampling(), Request()).status.ok());
}

TEST(SampleStop, LostConnectionStopsTheRunWithin100Ms) {
  StoppableRun run;
  TestServer server(run.Sampler(), OneWorker());
  steady_clock::time_point lost_at;
  {
    auto channel = server.NewChannel();
    auto stub = v1::SamplingService::NewStub(channel);
    grpc::ClientContext context;
    const auto reader = stub->Sample(&context, Request());
    run.WaitUntilStarted();
    lost_at = steady_clock::now();
    // Reader, context, stub and channel go here, as in a caller that dies.
  }
  EXPECT_LT(run.WaitUntilStopped() - lost_at, kStopWithin);
  EXPECT_TRUE(Sample(server.sampling(), Request()).status.ok());
}

TEST(SampleStop, CancelWhileWaitingFreesThePlace) {
  StoppableRun run;
  TestServer server(run.Sampler(), OneWorker());
  grpc::ClientContext running;
  const auto running_reader = server.sampling().Sample(&running, Request());
  run.WaitUntilStarted();
  grpc::ClientContext waiting;
  const auto waiting_reader = server.sampling().Sample(&waiting, Request());
  v1::SampleResponse event;
  ASSERT_TRUE(waiting_reader->Read(&event)) << waiting_reader->Finish().error_message();
  waiting.TryCancel();
  EXPECT_EQ(ReadAll(*waiting_reader).status.error_code(), grpc::StatusCode::CANCELLED);
  running.TryCancel();
  ReadAll(*running_reader);
  run.WaitUntilStopped();
}

}  // namespace
}  // namespace ccst::server
