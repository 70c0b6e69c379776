#include "server/app/server_options.h"

#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

TEST(ServerOptions, DefaultsAreValid) { EXPECT_TRUE(ServerOptions().Validate().ok()); }

TEST(ServerOptions, WrongValuesNameTheirFlag) {
  const auto message = [](auto change) {
    ServerOptions options;
    change(options);
    const absl::Status status = options.Validate();
    EXPECT_EQ(GetErrorReason(status), ErrorReason::kOptionInvalid);
    return std::string(status.message());
  };
  EXPECT_EQ(message([](auto& o) { o.listen = "nowhere"; }).rfind("--listen ", 0), 0U);
  EXPECT_EQ(message([](auto& o) { o.listen = "127.0.0.1:99999"; }).rfind("--listen must be ", 0),
            0U);
  EXPECT_EQ(message([](auto& o) {
              o.metrics_listen = "127.0.0.1:0,127.0.0.2:0";
            }).rfind("--metrics-listen must be ", 0),
            0U);
  EXPECT_EQ(message([](auto& o) { o.metrics_listen = "0.0.0.0:0"; }).find("--metrics-insecure") !=
                std::string::npos,
            true);
  EXPECT_EQ(message([](auto& o) { o.security.health_cert = "cert"; }).rfind("--health-cert ", 0),
            0U);
  EXPECT_EQ(message([](auto& o) { o.threads_per_job = 0; }).rfind("--threads ", 0), 0U);
  EXPECT_EQ(message([](auto& o) { o.runner.max_running_jobs = 0; }).rfind("--max-running-jobs ", 0),
            0U);
  EXPECT_EQ(message([](auto& o) {
              o.drain_timeout_seconds = std::numeric_limits<double>::quiet_NaN();
            }).rfind("--drain-timeout ", 0),
            0U);
  EXPECT_EQ(message([](auto& o) {
              o.request_limits.max_inline_mesh_bytes = std::int64_t{2} << 30;
            }).rfind("--max-inline-mesh-bytes ", 0),
            0U);
}

TEST(ServerOptions, OpenMetricsHaveAnAcceptanceOfTheirOwn) {
  ServerOptions options;
  options.metrics_listen = "0.0.0.0:0";
  options.security.metrics_insecure = true;
  EXPECT_TRUE(options.Validate().ok()) << options.Validate();
  // Which is none for the calls.
  options.listen = "0.0.0.0:0";
  EXPECT_FALSE(options.Validate().ok());
  options.security.insecure = true;
  EXPECT_FALSE(options.Validate().ok());  // The missing proxy has to be accepted as well.
  options.security.without_proxy = true;
  EXPECT_TRUE(options.Validate().ok());
  options.security.metrics_insecure = false;
  EXPECT_TRUE(options.Validate().ok());
}

TEST(ServerOptions, RunningTimesThreadsFitsTheCores) {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  EXPECT_EQ(DefaultMaxRunningJobs(1), cores);
  EXPECT_EQ(DefaultMaxRunningJobs(cores), 1);
  EXPECT_EQ(DefaultMaxRunningJobs(10 * cores), 1);
}

}  // namespace
}  // namespace ccst::server
