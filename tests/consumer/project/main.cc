#include <cstdio>

#include "core/sampling/sampling.h"

// Samples an octahedron; prints how many samples and triangles came out.
int main() {
  ccst::TriangleMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  ccst::SamplingOptions options;
  options.sample_count = 200;
  const absl::StatusOr<ccst::SamplingResult> result = ccst::SampleSurface(mesh, options);
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.status().ToString().c_str());
    return 1;
  }
  std::printf("%zu samples, %zu triangles\n", result->samples.positions.size(),
              result->samples.triangles.size());
}
