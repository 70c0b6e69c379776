// Requests as they arrive: the first byte names the type, the rest is the message as it travels.
// What the server reads of a request it accepts must be within the limits it advertises, and what
// it stores of it must be read back as it was.
#include <cstdlib>
#include <iterator>
#include <string>

#include "ccst/v1/mesh_service.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/base/status.h"
#include "proto/convert/field_limits.h"
#include "proto/convert/job_request.h"
#include "proto/convert/names.h"
#include "proto/convert/options.h"
#include "server/formats/earlier_formats.h"
#include "server/formats/job_definition.h"
#include "server/formats/job_history.h"
#include "server/formats/job_outcome.h"
#include "server/formats/mesh_facts.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/mesh_messages.h"
#include "tests/fuzz/target.h"

namespace {

namespace v1 = ccst::v1;

constexpr ccst::RequestLimits kLimits = {.max_inline_mesh_bytes = 1 << 16,
                                         .max_sample_count = 100'000,
                                         .max_iterations = 500,
                                         .max_texture_bytes = 1 << 12};

// A refusal says why in a way that programs understand.
void CheckRefusal(const absl::Status& status) {
  if (status.code() != absl::StatusCode::kInvalidArgument) std::abort();
  if (!ccst::GetErrorReason(status).has_value() || status.message().empty()) std::abort();
}

void Check(const absl::StatusOr<ccst::JobCall>& call) {
  if (!call.ok()) return CheckRefusal(call.status());
  const ccst::SamplingOptions& options = call->options;
  if (options.sample_count < 4 || options.sample_count > kLimits.max_sample_count) std::abort();
  if (options.max_iterations < 0 || options.max_iterations > kLimits.max_iterations) std::abort();
  if (!(options.relative_tolerance > 0.0)) std::abort();
  if (call->origin.has_value() && !call->origin->allFinite()) std::abort();
  if (call->preview_sample_count < 0) std::abort();
  if (call->preview_sample_count > ccst::kMaxPreviewSampleCount) std::abort();
  if (call->labels.size() > ccst::kMaxLabels) std::abort();
  // As it is shown to the caller, it is accepted again.
  const auto shown = ccst::ToProto(options);
  if (!shown.has_texture() && !ccst::FromProto(shown, kLimits).ok()) std::abort();
}

void RunSample(const std::string& bytes) {
  v1::SampleRequest request;
  if (request.ParseFromString(bytes)) Check(ccst::FromProto(request, kLimits));
}

void RunCreateJob(const std::string& bytes) {
  v1::CreateJobRequest request;
  if (request.ParseFromString(bytes)) Check(ccst::FromProto(request, kLimits));
}

// Reads a request as a call does, which first of all looks at the length of every field; false when
// it is none or refused.
template <typename Request>
bool Receive(const std::string& bytes, Request& request) {
  if (!request.ParseFromString(bytes)) return false;
  const absl::Status status = ccst::CheckFieldLimits(request);
  if (!status.ok()) CheckRefusal(status);
  return status.ok();
}

void RunListJobs(const std::string& bytes) {
  v1::ListJobsRequest request;
  if (!Receive(bytes, request)) return;
  ccst::Violations violations;
  ccst::server::FromProto(request, "owner", violations);
  const int size = ccst::server::PageSize(request.page_size(), violations);
  const absl::Status status = violations.ToStatus();
  if (!status.ok()) return CheckRefusal(status);
  if (size < 1 || size > ccst::server::kMaxPageSize) std::abort();
}

void RunFindMissing(const std::string& bytes) {
  v1::FindMissingMeshesRequest request;
  if (!Receive(bytes, request)) return;
  const auto digests = ccst::server::FromProto(request);
  if (!digests.ok()) return CheckRefusal(digests.status());
  if (digests->size() > ccst::kMaxDigests) std::abort();
}

const ccst::server::MeshStoreOptions& MeshLimits() {
  static const auto* const kOptions = new ccst::server::MeshStoreOptions();
  return *kOptions;
}

void RunUpload(const std::string& bytes) {
  v1::UploadMeshRequest request;
  if (!request.ParseFromString(bytes)) return;
  const auto upload = ccst::server::FromProto(request.header(), "owner", MeshLimits());
  if (!upload.ok()) CheckRefusal(upload.status());
}

void RunCreateMesh(const std::string& bytes) {
  v1::CreateMeshRequest request;
  if (!request.ParseFromString(bytes)) return;
  const auto upload =
      ccst::server::FromProto(request, "owner", MeshLimits(), kLimits.max_inline_mesh_bytes);
  if (!upload.ok()) CheckRefusal(upload.status());
}

// Names, which become keys of the store and of files: nothing but what was written as one.
void RunNames(const std::string& text) {
  ccst::Violations violations;
  const std::string sha256 = ccst::Sha256OfMeshName(text, "name", violations);
  if (violations.ToStatus().ok() && ccst::MeshName(sha256) != text) std::abort();
  ccst::Violations of_job;
  const std::string id = ccst::IdOfJobName(text, "name", of_job);
  if (of_job.ToStatus().ok() && ccst::JobName(id) != text) std::abort();
}

// What is stored: damaged bytes are told from whole ones, and whole ones survive being written
// anew.
void RunStored(const std::string& bytes) {
  if (const auto facts = ccst::server::DecodeFacts(bytes); facts.ok()) {
    const std::string again = ccst::server::EncodeFacts(*facts);
    const auto twice = ccst::server::DecodeFacts(again);
    if (!twice.ok() || ccst::server::EncodeFacts(*twice) != again) std::abort();
  }
  if (const auto definition = ccst::server::DecodeDefinition(bytes); definition.ok()) {
    const std::string again = ccst::server::EncodeDefinition(*definition);
    const auto twice = ccst::server::DecodeDefinition(again);
    if (!twice.ok() || ccst::server::EncodeDefinition(*twice) != again) std::abort();
  }
  if (const auto outcome = ccst::server::DecodeOutcome(bytes); outcome.ok()) {
    const std::string again = ccst::server::EncodeOutcome(*outcome);
    if (!ccst::server::DecodeOutcome(again).ok()) std::abort();
  }
  if (const auto history = ccst::server::DecodeHistory(bytes); history.ok()) {
    const auto twice = ccst::server::DecodeHistory(ccst::server::EncodeHistory(*history));
    if (!twice.ok() || twice->size() != history->size()) std::abort();
  }
}

// What earlier versions stored becomes something that can be read.
void RunEarlier(const std::string& bytes) {
  const auto definition = ccst::server::UpgradeDefinition(bytes);
  if (definition.ok() && !ccst::server::DecodeDefinition(*definition).ok()) std::abort();
  const auto outcome = ccst::server::UpgradeOutcome(bytes);
  if (outcome.ok() && !ccst::server::DecodeOutcome(*outcome).ok()) std::abort();
  const auto history = ccst::server::UpgradeHistory(bytes);
  if (history.ok() && !ccst::server::DecodeHistory(*history).ok()) std::abort();
  const auto facts = ccst::server::UpgradeFacts(bytes);
  if (facts.ok() && !ccst::server::DecodeFacts(*facts).ok()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using Run = void (*)(const std::string&);
  constexpr Run kRuns[] = {RunSample,     RunCreateJob, RunListJobs, RunFindMissing, RunUpload,
                           RunCreateMesh, RunNames,     RunStored,   RunEarlier};
  if (size == 0) return 0;
  kRuns[data[0] % std::size(kRuns)](std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  return 0;
}
