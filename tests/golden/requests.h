#pragma once

#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst::golden {

/// A small request whose samples are known.
struct Request {
  std::string name;  ///< One word, unique.
  TriangleMesh mesh;
  SamplingOptions options;
};

/// Requests that pass every step of the sampler: all methods and densities, creases, boundaries,
/// several components, meshes in need of repair, blocks on several threads. Together they take a
/// few seconds. Coordinates are multiples of 2^-16, so that the meshes do not depend on the last
/// bits of a library's sines.
std::vector<Request> Requests();

/// The digest of the request's samples (core/io/samples_digest.h), or the error's text.
std::string DigestOf(const Request& request);

}  // namespace ccst::golden
