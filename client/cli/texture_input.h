#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/sampling/sampling.h"

namespace ccst::cli {

/// Reads the image of a texture density, both as it travels and decoded, so that one that is no
/// image is refused here. @errors those of ReadWholeFile() and DecodeImage(), with the path
absl::Status ReadTexture(const std::string& path, DensityOptions& density);

}  // namespace ccst::cli
