#pragma once

#include <optional>

#include "ccst/v1/job.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/run_control.h"
#include "core/sampling/sampling.h"

namespace ccst {

v1::Energy ToProto(Energy energy);
v1::SamplingMethod ToProto(SamplingMethod method);
v1::CurvatureDensity::Measure ToProto(CurvatureMeasure measure);
v1::JobPhase ToProto(Phase phase);
v1::TerminationReason ToProto(Termination termination);
v1::AttributeKind ToProto(AttributeKind kind);

/// Empty for values this version does not know. Unspecified is the default, kTarget.
std::optional<Energy> FromProto(v1::Energy energy);
/// Likewise; unspecified is the default, kCcst.
std::optional<SamplingMethod> FromProto(v1::SamplingMethod method);
/// Likewise; unspecified is the default, kGaussian.
std::optional<CurvatureMeasure> FromProto(v1::CurvatureDensity::Measure measure);

/// Empty for unspecified and for values this version does not know.
std::optional<Phase> FromProto(v1::JobPhase phase);
std::optional<Termination> FromProto(v1::TerminationReason reason);

/// Empty for values this version does not know. Unspecified is kScalar.
std::optional<AttributeKind> FromProto(v1::AttributeKind kind);

}  // namespace ccst
