#pragma once

#include <string>

#include "core/sampling/sampling.h"

namespace ccst {

/// SHA-256, as 64 lowercase hexadecimal digits, of hosts, barycentrics and triangles in the
/// byte layout of proto/docs/samples.md. Equal digests mean equal samples, bit for bit.
/// `samples.faces` and `samples.barycentrics` must be of one length. Cost O(n).
std::string SamplesDigest(const SampleSet& samples);

}  // namespace ccst
