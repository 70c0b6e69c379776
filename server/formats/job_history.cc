#include "server/formats/job_history.h"

#include "core/base/status.h"
#include "server/formats/reports.h"
#include "server/formats/stored_message.h"

namespace ccst::server {

std::string EncodeHistory(std::span<const AlternationReport> reports) {
  if (reports.empty()) return "";
  store::v1::History message;
  message.set_format(internal::kFormat);
  for (const AlternationReport& report : reports) internal::Write(report, *message.add_reports());
  return message.SerializeAsString();
}

absl::StatusOr<std::vector<AlternationReport>> DecodeHistory(const std::string& bytes) {
  std::vector<AlternationReport> reports;
  if (bytes.empty()) return reports;
  store::v1::History message;
  CCST_RETURN_IF_ERROR(internal::ParseStored(bytes, "history of a job is", message));
  reports.reserve(static_cast<std::size_t>(message.reports_size()));
  for (const store::v1::Report& report : message.reports()) {
    reports.push_back(internal::Read(report));
  }
  return reports;
}

}  // namespace ccst::server
