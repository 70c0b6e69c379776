#pragma once

#include <string>

#include "absl/status/status.h"
#include "ccst/v1/sampling_service.pb.h"

namespace ccst::interleavings {

/// What determines samples: equal keys must give equal samples.
std::string SpecKey(const v1::JobSpec& spec);
std::string SpecKey(const v1::SampleRequest& request);

/// `meshes/...` of encoded bytes.
std::string NameOfMesh(const std::string& bytes);

/// Code, reason and message of a status.
std::string Text(const absl::Status& status);

}  // namespace ccst::interleavings
