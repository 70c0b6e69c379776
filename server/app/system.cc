#include "server/app/system.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <random>

#include "absl/time/clock.h"
#include "core/base/status.h"
#include "core/io/draco_header.h"
#include "core/io/draco_mesh.h"
#include "core/io/image_file.h"
#include "core/io/samples_digest.h"

namespace ccst::server {

Clock SystemClock() {
  return {.now = [] { return absl::Now(); },
          .seconds =
              [] {
                return std::chrono::duration<double>(
                           std::chrono::steady_clock::now().time_since_epoch())
                    .count();
              }};
}

void WriteToStandardError(const std::string& line) {
  std::fprintf(stderr, "%s\n", line.c_str());
  std::fflush(stderr);
}

std::string NewUuid() {
  std::random_device device;
  std::array<std::uint32_t, 4> words;
  for (std::uint32_t& word : words) word = device();
  words[1] = (words[1] & 0xFFFF0FFFU) | 0x00004000U;  // Version 4.
  words[2] = (words[2] & 0x3FFFFFFFU) | 0x80000000U;  // RFC 4122 variant.
  std::array<char, 37> text;
  std::snprintf(text.data(), text.size(), "%08x-%04x-%04x-%04x-%04x%08x", words[0], words[1] >> 16,
                words[1] & 0xFFFFU, words[2] >> 16, words[2] & 0xFFFFU, words[3]);
  return text.data();
}

absl::StatusOr<MeshCounts> CountDraco(std::span<const char> start, std::int64_t size,
                                      const MeshLimits& limits) {
  io::DracoHeader header;
  CCST_ASSIGN_OR_RETURN(header, io::ReadDracoHeader(start));
  CCST_RETURN_IF_ERROR(io::CheckDracoCounts(header, static_cast<std::size_t>(size), limits));
  return MeshCounts{.vertices = header.points, .faces = header.faces};
}

RunDependencies RealRunDependencies(const Clock& clock, const MeshLimits& mesh_limits) {
  return {.count = CountDraco,
          .decode = DecodeDraco,
          .decode_image = [](std::span<const char> bytes) { return DecodeImage(bytes); },
          .sample = SampleSurface,
          .digest = SamplesDigest,
          .clock = clock,
          .mesh_limits = mesh_limits,
          .threads_per_job = 1};
}

}  // namespace ccst::server
