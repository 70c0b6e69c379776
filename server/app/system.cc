#include "server/app/system.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <random>

#include <unistd.h>

#include "absl/time/clock.h"
#include "core/base/status.h"
#include "core/io/draco_announced.h"
#include "core/io/draco_mesh.h"
#include "core/io/image_file.h"
#include "core/io/samples_digest.h"
#include "server/app/library_log.h"
#include "server/base/lost_log_lines.h"
#include "server/log/log_stream.h"

namespace ccst::server {
namespace {

// Never taken down: libraries may log until the process is gone.
LogStream& StandardError() {
  static LogStream& stream = *new LogStream(STDERR_FILENO);
  return stream;
}

}  // namespace

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
  StandardError().Write(line);
  lost_log_lines = StandardError().lost_lines();
}

void TendLog() {
  TendLibraryLog();
  StandardError().Flush();
  lost_log_lines = StandardError().lost_lines();
}

void FinishLog() { StandardError().FlushWithin(std::chrono::seconds(1)); }

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

absl::StatusOr<MeshCounts> CountDraco(const ByteSource& source, const MeshLimits& limits) {
  io::DracoAnnouncement announced;
  CCST_ASSIGN_OR_RETURN(announced, io::ReadDracoAnnouncement(source, limits));
  const io::DracoMemory memory = io::MemoryOf(announced);
  return MeshCounts{.vertices = announced.header.points,
                    .faces = announced.header.faces,
                    .encoded_bytes = source.size,
                    .decoder_bytes = memory.decoder_bytes,
                    .mesh_bytes = memory.mesh_bytes,
                    .sample_bytes = memory.sample_bytes};
}

RunDependencies RealRunDependencies(const Clock& clock, const MeshLimits& mesh_limits) {
  return {.count = CountDraco,
          .image_facts = [](const ByteSource& source) { return ReadImageFacts(source); },
          .decode = DecodeDraco,
          .decode_image = [](std::span<const char> bytes) { return DecodeImage(bytes); },
          .sample = SampleSurface,
          .digest = SamplesDigest,
          .clock = clock,
          .mesh_limits = mesh_limits,
          .threads_per_job = 1};
}

}  // namespace ccst::server
