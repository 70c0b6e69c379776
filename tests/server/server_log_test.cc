#include "server/log/server_log.h"

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ccst::server {
namespace {

RequestRecord Record() {
  RequestRecord record;
  record.method = "Sample";
  record.job = "jobs/1";
  record.owner = "alice";
  record.trace_id = "4bf92f3577b34da6a3ce929d0e0e4736";
  record.code = "OK";
  record.seconds = 0.25;
  record.samples_requested = 5;
  record.samples_sent = 5;
  return record;
}

std::string LineOf(LogFormat format, const RequestRecord& record) {
  std::string written;
  ServerLog log(
      format, [] { return absl::UnixEpoch(); }, [&](const std::string& line) { written += line; });
  log.Request(record);
  return written;
}

TEST(ServerLogFormat, TextIsOneReadableLine) {
  EXPECT_EQ(LineOf(LogFormat::kText, Record()),
            "1970-01-01T00:00:00.000Z Sample OK 250.0 ms jobs/1 owner=alice "
            "trace=4bf92f3577b34da6a3ce929d0e0e4736 request_bytes=0 response_bytes=0 samples=5/5 "
            "messages=0");
}

TEST(ServerLogFormat, JsonIsOneObject) {
  RequestRecord record = Record();
  record.reason = "A \"quoted\"\nreason";
  const std::string line = LineOf(LogFormat::kJson, record);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["method"], "Sample");
  EXPECT_EQ(json["reason"], record.reason);
  EXPECT_EQ(json["seconds"], 0.25);
  EXPECT_EQ(json["owner"], "alice");
  EXPECT_EQ(json["trace_id"], record.trace_id);
}

TEST(ServerLogFormat, TextsOfOthersStayOnTheirLine) {
  const std::string hostile =
      "x\n1970-01-01T00:00:00.000Z draining\x1b[2J\xc2\x9b"
      "m\xff\xe2\x80\xae";
  RequestRecord record = Record();
  record.job = record.owner = record.reason = record.method = hostile;
  for (const LogFormat format : {LogFormat::kText, LogFormat::kJson}) {
    std::string lines = LineOf(format, record) + "|";
    ServerLog log(
        format, [] { return absl::UnixEpoch(); }, [&](const std::string& line) { lines += line; });
    log.Message(hostile);
    for (const char* obeyed : {"\n", "\x1b", "\xc2\x9b", "\xff", "\xe2\x80\xae"}) {
      EXPECT_EQ(lines.find(obeyed), std::string::npos) << lines;
    }
    EXPECT_NE(lines.find("draining\\u001b[2J\\u009bm"), std::string::npos) << lines;
  }
}

TEST(ServerLogFormat, MessagesHaveALength) {
  for (const LogFormat format : {LogFormat::kText, LogFormat::kJson}) {
    std::string line;
    ServerLog log(
        format, [] { return absl::UnixEpoch(); }, [&](const std::string& text) { line = text; });
    log.Message(std::string(1 << 20, 'x'));
    EXPECT_LT(line.size(), 5000U);
  }
}

}  // namespace
}  // namespace ccst::server
