#include "core/sampling/sampling.h"

namespace ccst {

absl::StatusOr<SamplingResult> SampleSurface(const TriangleMesh&, const SamplingOptions&,
                                             const RunControl&) {
  return absl::UnimplementedError("being written");
}

}  // namespace ccst
