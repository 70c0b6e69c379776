#pragma once

#include <string>

#include "core/sampling/result.h"

namespace ccst::io {

/// The samples as a binary PCD 0.7 of the Point Cloud Library, which takes coordinates as 32-bit
/// floats: x y z normal_x normal_y normal_z, the first colours packed as rgb, and the further
/// fields of ToRows().
std::string EncodePcd(const SampleSet& samples);

/// The samples and the triangles over them as VTK's PolyData (.vtp), raw and little endian: points
/// in doubles, `normals`, `face`, `barycentrics`, `face_corners` where faces are polygons, and the
/// attributes' columns as point data. Without triangles every sample is a vertex of its own.
std::string EncodeVtp(const SampleSet& samples);

}  // namespace ccst::io
