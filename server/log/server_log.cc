#include "server/log/server_log.h"

#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"

namespace ccst::server {
namespace {

std::string Timestamp(absl::Time time) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", time, absl::UTCTimeZone());
}

std::string Milliseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", seconds * 1e3);
  return text;
}

}  // namespace

ServerLog::ServerLog(LogFormat format, std::function<absl::Time()> now,
                     std::function<void(const std::string&)> write)
    : format_(format), now_(std::move(now)), write_(std::move(write)) {}

void ServerLog::Request(const RequestRecord& record) {
  const std::string time = Timestamp(now_());
  if (format_ == LogFormat::kJson) {
    Write(nlohmann::ordered_json{{"time", time},
                                 {"method", record.method},
                                 {"job", record.job},
                                 {"owner", record.owner},
                                 {"trace_id", record.trace_id},
                                 {"code", record.code},
                                 {"reason", record.reason},
                                 {"seconds", record.seconds},
                                 {"request_bytes", record.request_bytes},
                                 {"response_bytes", record.response_bytes},
                                 {"samples_requested", record.samples_requested},
                                 {"samples_sent", record.samples_sent},
                                 {"messages_sent", record.messages_sent}}
              .dump());
    return;
  }
  std::string line = absl::StrCat(time, " ", record.method, " ", record.code);
  if (!record.reason.empty()) absl::StrAppend(&line, " ", record.reason);
  absl::StrAppend(&line, " ", Milliseconds(record.seconds), " ms");
  if (!record.job.empty()) absl::StrAppend(&line, " ", record.job);
  absl::StrAppend(&line, " owner=", record.owner);
  if (!record.trace_id.empty()) absl::StrAppend(&line, " trace=", record.trace_id);
  absl::StrAppend(&line, " request_bytes=", record.request_bytes,
                  " response_bytes=", record.response_bytes, " samples=", record.samples_sent, "/",
                  record.samples_requested, " messages=", record.messages_sent);
  Write(line);
}

void ServerLog::Message(std::string_view message) {
  const std::string time = Timestamp(now_());
  if (format_ == LogFormat::kJson) {
    Write(nlohmann::ordered_json{{"time", time}, {"message", std::string(message)}}.dump());
  } else {
    Write(absl::StrCat(time, " ", std::string(message)));
  }
}

void ServerLog::Write(const std::string& line) {
  const std::lock_guard lock(mutex_);
  write_(line);
}

}  // namespace ccst::server
