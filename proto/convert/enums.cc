#include "proto/convert/enums.h"

namespace ccst {

v1::Energy ToProto(Energy energy) {
  switch (energy) {
    case Energy::kTarget:
      return v1::ENERGY_TARGET;
    case Energy::kSquaredArea:
      return v1::ENERGY_SQUARED_AREA;
  }
  return v1::ENERGY_UNSPECIFIED;
}

v1::JobPhase ToProto(Phase phase) {
  switch (phase) {
    case Phase::kPreparing:
      return v1::JOB_PHASE_PREPARING;
    case Phase::kInitializing:
      return v1::JOB_PHASE_INITIALIZING;
    case Phase::kRelaxing:
      return v1::JOB_PHASE_RELAXING;
    case Phase::kFinalizing:
      return v1::JOB_PHASE_FINALIZING;
  }
  return v1::JOB_PHASE_UNSPECIFIED;
}

v1::TerminationReason ToProto(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return v1::TERMINATION_REASON_CONVERGED;
    case Termination::kIterationLimit:
      return v1::TERMINATION_REASON_ITERATION_LIMIT;
    case Termination::kTimeLimit:
      return v1::TERMINATION_REASON_TIME_LIMIT;
    case Termination::kStopped:
      return v1::TERMINATION_REASON_CANCELLED;
  }
  return v1::TERMINATION_REASON_UNSPECIFIED;
}

v1::CurvatureDensity::Measure ToProto(CurvatureMeasure measure) {
  switch (measure) {
    case CurvatureMeasure::kGaussian:
      return v1::CurvatureDensity::MEASURE_GAUSSIAN;
    case CurvatureMeasure::kMean:
      return v1::CurvatureDensity::MEASURE_MEAN;
    case CurvatureMeasure::kMaximum:
      return v1::CurvatureDensity::MEASURE_MAXIMUM;
  }
  return v1::CurvatureDensity::MEASURE_UNSPECIFIED;
}

std::optional<CurvatureMeasure> FromProto(v1::CurvatureDensity::Measure measure) {
  switch (measure) {
    case v1::CurvatureDensity::MEASURE_UNSPECIFIED:
    case v1::CurvatureDensity::MEASURE_GAUSSIAN:
      return CurvatureMeasure::kGaussian;
    case v1::CurvatureDensity::MEASURE_MEAN:
      return CurvatureMeasure::kMean;
    case v1::CurvatureDensity::MEASURE_MAXIMUM:
      return CurvatureMeasure::kMaximum;
    default:
      return std::nullopt;
  }
}

v1::SamplingMethod ToProto(SamplingMethod method) {
  switch (method) {
    case SamplingMethod::kCcst:
      return v1::SAMPLING_METHOD_CCST;
    case SamplingMethod::kWhiteNoise:
      return v1::SAMPLING_METHOD_WHITE_NOISE;
    case SamplingMethod::kPoissonDisk:
      return v1::SAMPLING_METHOD_POISSON_DISK;
    case SamplingMethod::kSampleElimination:
      return v1::SAMPLING_METHOD_SAMPLE_ELIMINATION;
    case SamplingMethod::kLloyd:
      return v1::SAMPLING_METHOD_LLOYD;
    case SamplingMethod::kCcvt:
      return v1::SAMPLING_METHOD_CCVT;
  }
  return v1::SAMPLING_METHOD_UNSPECIFIED;
}

std::optional<SamplingMethod> FromProto(v1::SamplingMethod method) {
  switch (method) {
    case v1::SAMPLING_METHOD_UNSPECIFIED:
    case v1::SAMPLING_METHOD_CCST:
      return SamplingMethod::kCcst;
    case v1::SAMPLING_METHOD_WHITE_NOISE:
      return SamplingMethod::kWhiteNoise;
    case v1::SAMPLING_METHOD_POISSON_DISK:
      return SamplingMethod::kPoissonDisk;
    case v1::SAMPLING_METHOD_SAMPLE_ELIMINATION:
      return SamplingMethod::kSampleElimination;
    case v1::SAMPLING_METHOD_LLOYD:
      return SamplingMethod::kLloyd;
    case v1::SAMPLING_METHOD_CCVT:
      return SamplingMethod::kCcvt;
    default:
      return std::nullopt;
  }
}

v1::AttributeKind ToProto(AttributeKind kind) {
  switch (kind) {
    case AttributeKind::kLabel:
      return v1::ATTRIBUTE_KIND_LABEL;
    case AttributeKind::kScalar:
      return v1::ATTRIBUTE_KIND_SCALAR;
    case AttributeKind::kColor:
      return v1::ATTRIBUTE_KIND_COLOR;
    case AttributeKind::kTextureCoordinates:
      return v1::ATTRIBUTE_KIND_TEXTURE_COORDINATES;
  }
  return v1::ATTRIBUTE_KIND_UNSPECIFIED;
}

std::optional<Energy> FromProto(v1::Energy energy) {
  switch (energy) {
    case v1::ENERGY_UNSPECIFIED:
    case v1::ENERGY_TARGET:
      return Energy::kTarget;
    case v1::ENERGY_SQUARED_AREA:
      return Energy::kSquaredArea;
    default:
      return std::nullopt;
  }
}

std::optional<Phase> FromProto(v1::JobPhase phase) {
  switch (phase) {
    case v1::JOB_PHASE_PREPARING:
      return Phase::kPreparing;
    case v1::JOB_PHASE_INITIALIZING:
      return Phase::kInitializing;
    case v1::JOB_PHASE_RELAXING:
      return Phase::kRelaxing;
    case v1::JOB_PHASE_FINALIZING:
      return Phase::kFinalizing;
    default:
      return std::nullopt;
  }
}

std::optional<Termination> FromProto(v1::TerminationReason reason) {
  switch (reason) {
    case v1::TERMINATION_REASON_CONVERGED:
      return Termination::kConverged;
    case v1::TERMINATION_REASON_ITERATION_LIMIT:
      return Termination::kIterationLimit;
    case v1::TERMINATION_REASON_TIME_LIMIT:
      return Termination::kTimeLimit;
    case v1::TERMINATION_REASON_CANCELLED:
      return Termination::kStopped;
    default:
      return std::nullopt;
  }
}

std::optional<AttributeKind> FromProto(v1::AttributeKind kind) {
  switch (kind) {
    case v1::ATTRIBUTE_KIND_UNSPECIFIED:
    case v1::ATTRIBUTE_KIND_SCALAR:
      return AttributeKind::kScalar;
    case v1::ATTRIBUTE_KIND_LABEL:
      return AttributeKind::kLabel;
    case v1::ATTRIBUTE_KIND_COLOR:
      return AttributeKind::kColor;
    case v1::ATTRIBUTE_KIND_TEXTURE_COORDINATES:
      return AttributeKind::kTextureCoordinates;
    default:
      return std::nullopt;
  }
}

}  // namespace ccst
