#include "server/log/server_log.h"

#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "core/base/printable_text.h"

namespace ccst::server {
namespace {

// Longer ones are a fault somewhere, and nobody reads them.
constexpr std::size_t kMaxMessageBytes = 4096;

std::string Timestamp(absl::Time time) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", time, absl::UTCTimeZone());
}

std::string Milliseconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", seconds * 1e3);
  return text;
}

// One line without control characters, whatever the strings hold.
std::string JsonLine(const nlohmann::ordered_json& json) {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  return PrintableText(json.dump(-1, ' ', false, kReplace));
}

}  // namespace

ServerLog::ServerLog(LogFormat format, std::function<absl::Time()> now,
                     std::function<void(const std::string&)> write)
    : format_(format), now_(std::move(now)), write_(std::move(write)) {}

void ServerLog::Request(const RequestRecord& record) {
  const std::string time = Timestamp(now_());
  if (format_ == LogFormat::kJson) {
    Write(JsonLine({{"time", time},
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
                    {"messages_sent", record.messages_sent}}));
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
  Write(PrintableText(line));
}

void ServerLog::Message(std::string_view message) {
  const std::string time = Timestamp(now_());
  if (format_ == LogFormat::kJson) {
    Write(
        JsonLine({{"time", time}, {"message", std::string(message.substr(0, kMaxMessageBytes))}}));
  } else {
    Write(absl::StrCat(time, " ", PrintableExcerpt(message, kMaxMessageBytes)));
  }
}

void ServerLog::Write(const std::string& line) {
  const std::lock_guard lock(mutex_);
  write_(line);
}

}  // namespace ccst::server
