#include "server/formats/earlier_formats.h"

#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "ccst/v1/sampling_service.pb.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/util/delimited_message_util.h"
#include "proto/convert/enums.h"
#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"
#include "server/formats/job_definition.h"
#include "server/formats/job_history.h"
#include "server/formats/job_outcome.h"
#include "server/formats/mesh_facts.h"
#include "server/formats/stored_message.h"

namespace ccst::server {
namespace {

constexpr char kEndsWithCaller[] = "ends-with-caller";

// What was accepted once must be readable when the limits are tighter.
constexpr RequestLimits kNoLimits = {.max_sample_count = std::numeric_limits<std::int64_t>::max(),
                                     .max_iterations = std::numeric_limits<int>::max(),
                                     .max_job_seconds = 1e12};

// With the limit in the form that every part of the server reads.
absl::Status ErrorOf(const v1::Status& message) {
  absl::Status error = ccst::FromProto(message);
  v1::LimitViolation passed;
  if (GetDetail(error, passed)) {
    SetPassedLimit({passed.limit(), passed.limit_value(), passed.requested_value()}, error);
  }
  return error;
}

std::shared_ptr<const JobResult> ResultOf(ResultFigures figures) {
  return std::make_shared<const JobResult>(
      JobResult{.run = std::move(figures.result),
                .sample_count = figures.sample_count,
                .triangle_count = figures.sample_mesh_face_count,
                .samples_sha256 = std::move(figures.record.samples_sha256),
                .samples_bytes = figures.record.samples_bytes,
                .queue_seconds = figures.record.queue_seconds,
                .decode_seconds = figures.record.decode_seconds,
                .total_seconds = figures.record.total_seconds,
                .warnings = std::move(figures.record.warnings)});
}

}  // namespace

absl::StatusOr<std::string> UpgradeDefinition(const std::string& bytes) {
  v1::CreateJobRequest request;
  if (!request.ParseFromString(bytes)) return internal::DamagedRecord("definition of a job is");
  // The image is stored apart, and options without one are refused.
  v1::SamplingOptions options = request.spec().options();
  if (options.has_texture()) options.mutable_texture()->set_image("-");
  JobDefinition definition;
  CCST_ASSIGN_OR_RETURN(definition.options, FromProto(options, kNoLimits));
  if (request.spec().has_origin()) definition.origin = ccst::FromProto(request.spec().origin());
  if (request.has_abandon_timeout()) {
    definition.abandon_seconds = SecondsFromProto(request.abandon_timeout());
  }
  definition.ends_with_caller = request.labels().contains(kEndsWithCaller);
  return EncodeDefinition(definition);
}

absl::StatusOr<std::string> UpgradeOutcome(const std::string& bytes) {
  if (bytes.empty()) return "";
  v1::Job job;
  if (!job.ParseFromString(bytes)) return internal::DamagedRecord("outcome of a job is");
  JobOutcome outcome;
  if (job.has_error()) outcome.error = ErrorOf(job.error());
  if (job.has_progress()) {
    outcome.phase = ccst::FromProto(job.progress().phase());
    outcome.last_report = ccst::FromProto(job.progress());
  }
  if (job.has_result()) {
    ResultFigures figures;
    CCST_ASSIGN_OR_RETURN(figures, ccst::FromProto(job.result()));
    outcome.result = ResultOf(std::move(figures));
  }
  return EncodeOutcome(outcome);
}

absl::StatusOr<std::string> UpgradeHistory(const std::string& bytes) {
  google::protobuf::io::ArrayInputStream in(bytes.data(), static_cast<int>(bytes.size()));
  std::vector<AlternationReport> reports;
  while (true) {
    v1::IterationProgress progress;
    bool clean_end = false;
    if (!google::protobuf::util::ParseDelimitedFromZeroCopyStream(&progress, &in, &clean_end)) {
      if (clean_end) return EncodeHistory(reports);
      return internal::DamagedRecord("history of a job is");
    }
    reports.push_back(ccst::FromProto(progress));
  }
}

absl::StatusOr<std::string> UpgradeFacts(const std::string& bytes) {
  v1::Mesh mesh;
  if (!mesh.ParseFromString(bytes)) return internal::DamagedRecord("facts of a mesh are");
  MeshFacts facts{.vertices = mesh.vertex_count(),
                  .file_faces = mesh.face_count(),
                  .components = mesh.component_count(),
                  .boundary_loops = mesh.boundary_loop_count(),
                  .area = mesh.surface_area(),
                  .bounds_min = ccst::FromProto(mesh.bounds_min()),
                  .bounds_max = ccst::FromProto(mesh.bounds_max()),
                  .attributes = {},
                  .warnings = {mesh.warnings().begin(), mesh.warnings().end()}};
  for (const v1::MeshAttribute& attribute : mesh.attributes()) {
    facts.attributes.push_back({.name = attribute.attribute_name(),
                                .components = attribute.component_count(),
                                .min_value = attribute.min_value(),
                                .max_value = attribute.max_value()});
  }
  return EncodeFacts(facts);
}

}  // namespace ccst::server
