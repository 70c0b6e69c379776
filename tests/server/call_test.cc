#include "server/rpc/call.h"

#include <gtest/gtest.h>

#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

constexpr char kTrace[] = "4bf92f3577b34da6a3ce929d0e0e4736";
constexpr char kTraceparent[] = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";

TEST(TraceId, IsThatOfAWellFormedTraceparent) {
  EXPECT_EQ(TraceId(kTraceparent), kTrace);
  EXPECT_EQ(TraceId("cc-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01-more"), kTrace);
}

// The cases of the W3C recommendation.
TEST(TraceId, WrongTraceparentHasNone) {
  for (const char* wrong : {"", "00", "ff-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
                            "00-00000000000000000000000000000000-00f067aa0ba902b7-01",
                            "00-4bf92f3577b34da6a3ce929d0e0e4736-0000000000000000-01",
                            "00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01",
                            "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-0g",
                            "00_4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
                            "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01-more",
                            "cc-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01.more"}) {
    EXPECT_EQ(TraceId(wrong), "") << wrong;
  }
}

TEST(Call, LineOfAUnaryCallIsThereBeforeItsAnswer) {
  TestServer server(QuickSampler());
  grpc::ClientContext context;
  context.AddMetadata("traceparent", kTraceparent);
  v1::GetServerInfoResponse response;
  ASSERT_TRUE(server.info().GetServerInfo(&context, {}, &response).ok());
  const std::string line = server.LogLines().back();
  EXPECT_NE(line.find(" GetServerInfo OK "), std::string::npos) << line;
  EXPECT_NE(line.find(" owner=127.0.0.1 "), std::string::npos) << line;
  EXPECT_NE(line.find(std::string(" trace=") + kTrace + " "), std::string::npos) << line;
  EXPECT_NE(line.find(" response_bytes=" + std::to_string(response.ByteSizeLong()) + " "),
            std::string::npos)
      << line;
}

}  // namespace
}  // namespace ccst::server
