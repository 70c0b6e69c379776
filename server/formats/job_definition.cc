#include "server/formats/job_definition.h"

#include "core/base/status.h"
#include "server/formats/option_list.h"
#include "server/formats/stored_message.h"
#include "server/formats/vectors.h"

namespace ccst::server {

std::string EncodeDefinition(const JobDefinition& definition) {
  store::v1::Definition message;
  message.set_format(internal::kFormat);
  SamplingOptions options = definition.options;
  options.thread_count = SamplingOptions().thread_count;
  internal::WriteOptions(options, *message.mutable_options());
  if (definition.origin.has_value()) internal::Write(*definition.origin, *message.mutable_origin());
  if (definition.abandon_seconds.has_value()) {
    message.set_abandon_seconds(*definition.abandon_seconds);
  }
  message.set_ends_with_caller(definition.ends_with_caller);
  return message.SerializeAsString();
}

absl::StatusOr<JobDefinition> DecodeDefinition(const std::string& bytes) {
  store::v1::Definition message;
  CCST_RETURN_IF_ERROR(internal::ParseStored(bytes, "definition of a job is", message));
  JobDefinition definition;
  CCST_RETURN_IF_ERROR(internal::ReadOptions(message.options(), definition.options));
  if (message.has_origin()) definition.origin = internal::Read(message.origin());
  if (message.has_abandon_seconds()) definition.abandon_seconds = message.abandon_seconds();
  definition.ends_with_caller = message.ends_with_caller();
  return definition;
}

}  // namespace ccst::server
