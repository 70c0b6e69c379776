#pragma once

#include <cstdint>
#include <string>

#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"

namespace ccst::test {

/// A mesh, what to ask of it, and how to call it in a message.
struct StretchedCase {
  TriangleMesh mesh;
  SamplingOptions options;
  std::string name;
};

/// The case of this number: a small mesh, open or closed, with holes, creases, several pieces or
/// defects, under a random affine map that stretches by 1e-9 to 1e9, with random options. Always
/// the same.
StretchedCase MakeStretchedCase(std::uint64_t number);

/// Two triangles: a strip in the plane.
TriangleMesh Strip(double length, double width);

/// Sheets a hair apart, one over the other and all of one piece.
TriangleMesh Pile(int sheets);

}  // namespace ccst::test
