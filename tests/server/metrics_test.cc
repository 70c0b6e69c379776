#include "server/metrics/metrics.h"

#include <map>
#include <sstream>
#include <string>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/server/test_server.h"

namespace ccst::server {
namespace {

// What a web server at 127.0.0.1:PORT answers to GET `path`, with its headers.
std::string Get(const std::string& address, const std::string& path) {
  sockaddr_in where = {};
  where.sin_family = AF_INET;
  where.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int socket_fd = socket(AF_INET, SOCK_STREAM, 0);
  EXPECT_EQ(connect(socket_fd, reinterpret_cast<const sockaddr*>(&where), sizeof where), 0);
  const std::string request = "GET " + path + " HTTP/1.0\r\n\r\n";
  EXPECT_EQ(write(socket_fd, request.data(), request.size()), static_cast<ssize_t>(request.size()));
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
                     .memory_limit_bytes = 5};
  metrics.SetLoadReader([&load] { return load; });
  auto samples = Scrape(address);
  EXPECT_EQ(samples["ccst_jobs_queued"], 1);
  EXPECT_EQ(samples["ccst_jobs_running"], 2);
  EXPECT_EQ(samples["ccst_watchers"], 3);
  EXPECT_EQ(samples["ccst_memory_bytes"], 4);
  EXPECT_EQ(samples["ccst_memory_limit_bytes"], 5);
  load.queued_jobs = 9;
  EXPECT_EQ(Scrape(address)["ccst_jobs_queued"], 9);
  metrics.SetLoadReader({});
  EXPECT_EQ(Scrape(address).count("ccst_jobs_queued"), 0U);
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
