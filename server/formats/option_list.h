#pragma once

#include "absl/status/status.h"
#include "ccst/store/v1/record.pb.h"
#include "core/sampling/options.h"

namespace ccst::server::internal {

using OptionList = google::protobuf::RepeatedPtrField<store::v1::Option>;

/// Adds all options but images, and optional ones that are not set.
void WriteOptions(const SamplingOptions& options, OptionList& list);

/// The reverse; what the list leaves out stays as it is in `options`, and what this version does
/// not know is passed over.
/// @errors DATA_LOSS STORAGE_FAILED a value is of another kind than the option, or out of its range
absl::Status ReadOptions(const OptionList& list, SamplingOptions& options);

}  // namespace ccst::server::internal
