#include "server/metrics/metrics.h"

#include <chrono>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/base/lost_log_lines.h"
#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

// A connection to 127.0.0.1:PORT on which `text` was sent.
int Send(const std::string& address, const std::string& text) {
  sockaddr_in where = {};
  where.sin_family = AF_INET;
  where.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int socket_fd = socket(AF_INET, SOCK_STREAM, 0);
  EXPECT_EQ(connect(socket_fd, reinterpret_cast<const sockaddr*>(&where), sizeof where), 0);
  EXPECT_EQ(write(socket_fd, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  return socket_fd;
}

// What a web server at 127.0.0.1:PORT answers to GET `path`, with its headers.
std::string Get(const std::string& address, const std::string& path) {
  const int socket_fd = Send(address, "GET " + path + " HTTP/1.0\r\n\r\n");
  std::string answer;
  char buffer[4096];
  for (ssize_t n = 0; (n = read(socket_fd, buffer, sizeof buffer)) > 0;) {
    answer.append(buffer, static_cast<std::size_t>(n));
  }
  close(socket_fd);
  return answer;
}

// The samples of the page by name and labels, as Prometheus reads them.
std::map<std::string, double> Scrape(const std::string& address) {
  std::istringstream page(Get(address, "/metrics"));
  std::map<std::string, double> samples;
  for (std::string line; std::getline(page, line);) {
    const std::size_t space = line.rfind(' ');
    if (line.rfind("ccst_", 0) == 0) samples[line.substr(0, space)] = std::stod(line.substr(space));
  }
  return samples;
}

TEST(Metrics, CountsAreOnThePage) {
  Metrics metrics;
  const std::string address = *metrics.Serve("127.0.0.1:0");
  metrics.CountRequest("Sample", "OK", 0.2, 100, 1000);
  metrics.CountRequest("Sample", "OK", 7.0, 10, 1);
  metrics.CountRequest("Sample", "CANCELLED", 0.0, 0, 0);
  metrics.OnPhase("relaxing", 0.75);
  metrics.OnAlternation();
  metrics.OnAlternation();
  metrics.OnEnd("succeeded", 1.5);
  metrics.OnCancel("drain");
  metrics.OnCacheLookup("result", true);
  metrics.OnCacheLookup("result", false);
  metrics.OnCacheLookup("result", false);
  auto samples = Scrape(address);
  EXPECT_EQ(samples[R"(ccst_requests_total{code="OK",method="Sample"})"], 2);
  EXPECT_EQ(samples[R"(ccst_requests_total{code="CANCELLED",method="Sample"})"], 1);
  EXPECT_EQ(samples[R"(ccst_request_seconds_count{method="Sample"})"], 3);
  EXPECT_DOUBLE_EQ(samples[R"(ccst_request_seconds_sum{method="Sample"})"], 7.2);
  EXPECT_EQ(samples[R"(ccst_request_seconds_bucket{method="Sample",le="0.25"})"], 2);
  EXPECT_EQ(samples[R"(ccst_request_seconds_bucket{method="Sample",le="+Inf"})"], 3);
  EXPECT_EQ(samples[R"(ccst_request_bytes_total{method="Sample"})"], 110);
  EXPECT_EQ(samples[R"(ccst_response_bytes_total{method="Sample"})"], 1001);
  EXPECT_EQ(samples[R"(ccst_phase_seconds_sum{phase="relaxing"})"], 0.75);
  EXPECT_EQ(samples["ccst_alternations_total"], 2);
  EXPECT_EQ(samples[R"(ccst_job_seconds_sum{state="succeeded"})"], 1.5);
  EXPECT_EQ(samples[R"(ccst_job_cancels_total{reason="drain"})"], 1);
  EXPECT_EQ(samples[R"(ccst_cache_lookups_total{cache="result",result="hit"})"], 1);
  EXPECT_EQ(samples[R"(ccst_cache_lookups_total{cache="result",result="miss"})"], 2);
}

TEST(Metrics, GaugesAreReadWithEveryScrape) {
  Metrics metrics;
  const std::string address = *metrics.Serve("127.0.0.1:0");
  LoadSample load = {.queued_jobs = 1,
                     .running_jobs = 2,
                     .watchers = 3,
                     .memory_bytes = 4,
                     .memory_limit_bytes = 5,
                     .data_bytes = 6,
                     .data_limit_bytes = 7,
                     .record_bytes = 8,
                     .record_limit_bytes = 9};
  metrics.SetLoadReader([&load] { return load; });
  auto samples = Scrape(address);
  EXPECT_EQ(samples["ccst_jobs_queued"], 1);
  EXPECT_EQ(samples["ccst_jobs_running"], 2);
  EXPECT_EQ(samples["ccst_watchers"], 3);
  EXPECT_EQ(samples["ccst_memory_bytes"], 4);
  EXPECT_EQ(samples["ccst_memory_limit_bytes"], 5);
  EXPECT_EQ(samples["ccst_data_bytes"], 6);
  EXPECT_EQ(samples["ccst_data_limit_bytes"], 7);
  EXPECT_EQ(samples["ccst_record_bytes"], 8);
  EXPECT_EQ(samples["ccst_record_limit_bytes"], 9);
  load.queued_jobs = 9;
  EXPECT_EQ(Scrape(address)["ccst_jobs_queued"], 9);
  metrics.SetLoadReader({});
  EXPECT_EQ(Scrape(address).count("ccst_jobs_queued"), 0U);
}

// As many as a scraper with a bad network has, and then some that mean harm: the page answers
// within what Prometheus waits, ten seconds.
TEST(Metrics, HalfRequestsDoNotBlockThePage) {
  for (const int count : {2, 40}) {
    Metrics metrics;
    const std::string address = *metrics.Serve("127.0.0.1:0");
    std::vector<int> halves;
    for (int i = 0; i < count; ++i) {
      halves.push_back(Send(address, "GET /metrics HTTP/1.1\r\nHost: x\r\nX-a: "));
    }
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_NE(Get(address, "/metrics").find("200 OK"), std::string::npos);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10)) << count;
    for (const int half : halves) close(half);
  }
}

TEST(Metrics, LostLinesOfTheLogAreCounted) {
  Metrics metrics;
  const std::string address = *metrics.Serve("127.0.0.1:0");
  metrics.SetLoadReader([] { return LoadSample(); });
  EXPECT_EQ(Scrape(address)["ccst_log_lines_lost_total"], 0);
  lost_log_lines = 7;
  EXPECT_EQ(Scrape(address)["ccst_log_lines_lost_total"], 7);
  lost_log_lines = 0;
}

TEST(Metrics, TakenAddressIsAnError) {
  Metrics first;
  const std::string address = *first.Serve("127.0.0.1:0");
  Metrics second;
  const auto taken = second.Serve(address);
  EXPECT_TRUE(absl::IsUnavailable(taken.status())) << taken.status();
  EXPECT_NE(taken.status().message().find(address), std::string::npos);
}

TEST(Metrics, ServerCountsItsCallsAndShowsItsQueue) {
  Gate started;
  Gate go;
  ServerOptions options;
  options.metrics_listen = "127.0.0.1:0";
  TestServer server(GatedSampler(started, go), options);
  const std::string address = server->metrics_address();
  grpc::ClientContext running_context;
  const auto running = server.sampling().Sample(&running_context, Request());
  started.Wait();
  grpc::ClientContext waiting_context;
  const auto waiting = server.sampling().Sample(&waiting_context, Request());
  v1::SampleResponse first;
  ASSERT_TRUE(waiting->Read(&first));  // It is in the queue.
  auto samples = Scrape(address);
  EXPECT_EQ(samples["ccst_jobs_queued"], 1);
  EXPECT_EQ(samples["ccst_jobs_running"], 1);
  waiting_context.TryCancel();
  ReadAll(*waiting);
  go.Open();
  ReadAll(*running);
  server->Drain();  // Every call is done, and so is its count.
  samples = Scrape(address);
  EXPECT_EQ(samples["ccst_jobs_queued"], 0);
  EXPECT_EQ(samples["ccst_jobs_running"], 0);
  EXPECT_EQ(samples[R"(ccst_requests_total{code="OK",method="Sample"})"], 1);
  EXPECT_EQ(samples[R"(ccst_requests_total{code="CANCELLED",method="Sample"})"], 1);
  EXPECT_GT(samples[R"(ccst_request_bytes_total{method="Sample"})"], 0);
  EXPECT_GT(samples[R"(ccst_response_bytes_total{method="Sample"})"], 0);
}

}  // namespace
}  // namespace ccst::server
