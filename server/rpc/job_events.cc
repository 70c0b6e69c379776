#include "server/rpc/job_events.h"

#include <algorithm>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/job_request.h"
#include "proto/convert/progress.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {

JobEvents::JobEvents(std::shared_ptr<const Job> job, std::int64_t after_sequence, int preview_count)
    : job_(std::move(job)),
      preview_count_(preview_count),
      next_report_(static_cast<std::size_t>(after_sequence)) {}

JobEvents::Kind JobEvents::Next() {
  if (TakeSnapshot()) return Kind::kSnapshot;
  if (TakeReport()) return Kind::kProgress;
  if (end_.has_value()) {
    // Not by the cursor, which may have been told to begin beyond all there is.
    sequence_ = static_cast<std::int64_t>(job_->Reports().size()) + 1;
    return Kind::kEnd;
  }
  return TakePreview() ? Kind::kPreview : Kind::kNothing;
}

bool JobEvents::TakeSnapshot() {
  if (end_.has_value() || job_->Version() == seen_version_) return false;
  const bool first = seen_version_ == 0;
  JobView view = job_->View();
  seen_version_ = view.version;
  if (HasEnded(view.state)) {
    end_ = view;
    if (!first) return false;
    // A run faster than its first message: say that it runs; how it ended comes last.
    view.state = JobState::kRunning;
    view.result = nullptr;
    view.error = absl::OkStatus();
    view.end_time.reset();
    view.expire_time.reset();
  }
  snapshot_ = ToProto(job_->id(), job_->spec(), view);
  return true;
}

bool JobEvents::TakeReport() {
  const auto report = job_->Report(next_report_);
  if (!report.has_value()) return false;
  progress_ = ccst::ToProto(*report, Phase::kRelaxing);
  elapsed_seconds_ = report->elapsed_seconds;
  ++next_report_;
  sequence_ = static_cast<std::int64_t>(next_report_);
  return true;
}

bool JobEvents::TakePreview() {
  if (preview_count_ == 0) return false;
  std::shared_ptr<const JobPreview> preview = job_->Preview();
  if (preview == nullptr || preview == seen_preview_) return false;
  preview_.Clear();
  preview_.set_iteration(preview->alternation);
  const std::size_t total = preview->positions.size() / 3;
  const std::size_t count = std::min(total, static_cast<std::size_t>(preview_count_));
  preview_.mutable_positions()->Reserve(static_cast<int>(3 * count));
  for (std::size_t i = 0; i < count; ++i) {
    const float* const position = preview->positions.data() + 3 * (i * total / count);
    preview_.mutable_positions()->Add(position, position + 3);
  }
  seen_preview_ = std::move(preview);
  return true;
}

std::int64_t EventBytes(int preview_count) {
  constexpr std::int64_t kSnapshotBytes = std::int64_t{8} << 10;  // Within FieldLimits().
  // Three floats, and half of the copy that is kept of the latest preview.
  constexpr std::int64_t kBytesOfPoint = 12 + 6;
  return kSnapshotBytes + kBytesOfPoint * std::clamp(preview_count, 0, kMaxPreviewSampleCount);
}

absl::Status GoingAway() {
  return MakeError(absl::StatusCode::kUnavailable, ErrorReason::kDraining,
                   "the server went away before the run was done");
}

}  // namespace ccst::server
