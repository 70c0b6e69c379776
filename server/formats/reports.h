#pragma once

#include "ccst/store/v1/record.pb.h"
#include "core/sampling/run_control.h"

namespace ccst::server::internal {

/// Without positions, and back.
void Write(const AlternationReport& report, store::v1::Report& message);
AlternationReport Read(const store::v1::Report& message);

}  // namespace ccst::server::internal
