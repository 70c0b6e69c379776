#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/sampling/result.h"

namespace ccst::io {

/// The samples as NumPy saves a structured array: one record a sample with the fields of ToRows(),
/// `numpy.load(f)["x"]`.
std::string EncodeNpy(const SampleSet& samples);

/// The samples as numpy.savez() saves arrays, not compressed: `positions` n x 3 double, `normals`
/// n x 3 float, `faces` n, `barycentrics` n x 2 double, `triangles` m x 3, `face_corners` n x 3
/// where faces are polygons, and each attribute's columns under their names. The same samples give
/// the same bytes.
/// @errors RESOURCE_EXHAUSTED  there is no memory
absl::StatusOr<std::string> EncodeNpz(const SampleSet& samples);

}  // namespace ccst::io
