// The real core behind a real server: how soon the first event comes, and how soon a worker is free
// when its caller goes. Best of several tries, for other programs take their share of the machine.
#include <algorithm>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "core/io/draco_mesh.h"
#include "server/app/system.h"
#include "tests/server/test_server.h"
#include "tests/support/shapes.h"

namespace ccst::server {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kTries = 5;

// About as many faces as a scanned model of the usual size: 20480.
v1::SampleRequest RealRequest(std::int64_t count, int levels) {
  v1::SampleRequest request = Request(count);
  request.mutable_inline_mesh()->set_data(*EncodeDraco(shapes::Icosphere(levels)));
  return request;
}

double MillisecondsSince(steady_clock::time_point start) {
  return duration<double, std::milli>(steady_clock::now() - start).count();
}

TEST(Latency, FirstEventComesWithin50Ms) {
  TestServer server(RealRunDependencies(SystemClock(), {}), {});
  const v1::SampleRequest request = RealRequest(2000, 5);
  double best = 1e9;
  for (int i = 0; i < kTries; ++i) {
    grpc::ClientContext context;
    const auto start = steady_clock::now();
    const auto reader = server.sampling().Sample(&context, request);
    v1::SampleResponse first;
    ASSERT_TRUE(reader->Read(&first));
    best = std::min(best, MillisecondsSince(start));
    context.TryCancel();
  }
  EXPECT_LT(best, 50.0);
}

TEST(Latency, FirstMessageComesBeforeTheMeshIsDecoded) {
  Gate go;
  RunDependencies run = RunWith(QuickSampler());
  run.decode = [&](std::span<const char>, const MeshLimits&) -> absl::StatusOr<TriangleMesh> {
    go.Wait();
    return TriangleMesh();
  };
  TestServer server(std::move(run), {});
  v1::GetServerInfoResponse info;
  grpc::ClientContext warm_up;
  ASSERT_TRUE(server.info().GetServerInfo(&warm_up, {}, &info).ok());
  grpc::ClientContext context;
  const auto start = steady_clock::now();
  const auto reader = server.sampling().Sample(&context, Request());
  v1::SampleResponse event;
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_LT(steady_clock::now() - start, milliseconds(50));
  EXPECT_TRUE(event.has_snapshot());
  go.Open();
  EXPECT_TRUE(ReadAll(*reader).status.ok());
}

// Cancels `after` the request was sent. @return milliseconds until no job runs any more.
double MillisecondsToFree(TestServer& server, const v1::SampleRequest& request,
                          milliseconds after) {
  grpc::ClientContext context;
  const auto reader = server.sampling().Sample(&context, request);
  v1::SampleResponse first;
  EXPECT_TRUE(reader->Read(&first));
  std::this_thread::sleep_for(after);
  const auto start = steady_clock::now();
  context.TryCancel();
  while (MillisecondsSince(start) < 5000.0) {
    grpc::ClientContext info_context;
    v1::GetServerInfoResponse info;
    EXPECT_TRUE(server.info().GetServerInfo(&info_context, {}, &info).ok());
    if (info.load().running_job_count() == 0) return MillisecondsSince(start);
    std::this_thread::sleep_for(milliseconds(2));
  }
  return 1e9;
}

TEST(Latency, CancelFreesTheRealWorkerWithin100MsInEveryPhase) {
  TestServer server(RealRunDependencies(SystemClock(), {}), {});
  // 327,680 faces: decoding, repairing, the first triangulation and the relaxation each take long
  // enough to be met.
  const v1::SampleRequest request = RealRequest(100'000, 7);
  for (const milliseconds after :
       {milliseconds(20), milliseconds(150), milliseconds(400), milliseconds(1200)}) {
    double best = 1e9;
    for (int i = 0; i < kTries && best > 100.0; ++i) {
      best = std::min(best, MillisecondsToFree(server, request, after));
    }
    std::printf("cancelled after %d ms: free within %.0f ms\n", static_cast<int>(after.count()),
                best);
    EXPECT_LT(best, 100.0) << after.count() << " ms after the request";
  }
}

}  // namespace
}  // namespace ccst::server
