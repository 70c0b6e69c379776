#include "tests/fuzz/sample_few.h"

#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/support/whole_job.h"

void SampleFew(const ccst::TriangleMesh& mesh, std::uint32_t choice) {
  // More faces would be more of the same, slower.
  constexpr std::size_t kMostFaces = 20'000;
  if (mesh.faces.size() > kMostFaces || mesh.positions.size() > kMostFaces) return;
  ccst::SamplingOptions options;
  options.method = static_cast<ccst::SamplingMethod>(choice % 8 < 6 ? choice % 8 : 0);
  options.sample_count = 4 + choice / 8 % 64;
  options.max_iterations = 20;
  if ((choice >> 9 & 1) != 0) options.crease_angle = 0.1 + (choice >> 10 & 7) * 0.4;
  if ((choice >> 13 & 7) == 1) options.density.source = ccst::DensitySource::kCurvature;
  const ccst::test::JobBounds bounds = {
      .seconds = 20.0,
      .bytes = (std::int64_t{16} << 20) +
               2000 * static_cast<std::int64_t>(mesh.faces.size() + mesh.positions.size())};
  const std::string fault = ccst::test::FindMisbehaviour(mesh, options, bounds);
  if (fault.empty()) return;
  std::fprintf(stderr, "sampling with choice %u: %s\n", choice, fault.c_str());
  std::abort();
}
