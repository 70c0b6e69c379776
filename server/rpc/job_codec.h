#pragma once

#include "server/jobs/job_codec.h"

namespace ccst::server {

/// What is stored of jobs, as messages of the API: the definition is a `CreateJobRequest`, the
/// outcome a `Job`, the history length-delimited `IterationProgress`. A field that is added to
/// those is kept from then on; old records stay readable as old messages do.
JobCodec ProtoJobCodec();

}  // namespace ccst::server
