#include "core/io/draco_guard.h"

#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/io/io_errors.h"
#include "draco/compression/config/compression_shared.h"
#include "draco/compression/entropy/symbol_decoding.h"
#include "draco/core/varint_decoding.h"
#include "draco/mesh/mesh.h"

namespace ccst::io {
namespace {

constexpr std::uint16_t kVersion22 = DRACO_BITSTREAM_VERSION(2, 2);

// Passes over an attribute's integers, which stand before the data of its prediction.
bool SkipIntegers(draco::DecoderBuffer& buffer, std::size_t entries, int components) {
  const std::size_t count = entries * static_cast<std::size_t>(components);
  std::uint8_t compressed = 0;
  if (!buffer.Decode(&compressed)) return false;
  if (compressed == 0) {
    std::uint8_t bytes = 0;
    if (!buffer.Decode(&bytes)) return false;
    const std::size_t size = bytes * count;
    if (size > static_cast<std::size_t>(buffer.remaining_size())) return false;
    buffer.Advance(static_cast<std::int64_t>(size));
    return true;
  }
  std::vector<std::uint32_t> ignored(count);
  return draco::DecodeSymbols(static_cast<std::uint32_t>(count), components, &buffer,
                              ignored.data());
}

}  // namespace

absl::Status CheckDracoAttributes(const draco::Mesh& mesh, std::size_t size,
                                  const MeshLimits& limits, std::int64_t announced_bytes) {
  // With seams there are more points than vertices were announced, though never more than
  // corners.
  const std::int64_t points = mesh.num_points();
  const std::int64_t corners = 3 * std::int64_t{mesh.num_faces()};
  std::int64_t needed = 0;
  std::int64_t value_total = 0;
  for (int i = 0; i < mesh.num_attributes(); ++i) {
    const draco::PointAttribute& attribute = *mesh.attribute(i);
    const std::int64_t components = attribute.num_components();
    const std::int64_t value_bytes = draco::DataTypeLength(attribute.data_type());
    // The values, the integers they are decoded from, the map from points to values, and what we
    // make of them: floats, by corner where they have to be.
    needed += points * (components * (value_bytes + 4) + 4) + 4 * corners * components;
    value_total += points * components * value_bytes;
  }
  if (value_total > announced_bytes) {
    return NotDraco(absl::StrCat("its attributes take ", value_total, " bytes, more than the ",
                                 announced_bytes, " for all that it announced"));
  }
  return CheckDracoMemory(
      needed, size, limits,
      absl::StrCat("announces ", mesh.num_attributes(), " attributes of ", points, " points"));
}

absl::Status CheckDracoOrientations(const draco::DecoderBuffer& buffer, std::size_t entries,
                                    int components, std::size_t corners) {
  if (buffer.decoded_size() < 2 || entries == 0 || components <= 0) return absl::OkStatus();
  const int method = buffer.data_head()[-2];
  const bool portable = method == draco::MESH_PREDICTION_TEX_COORDS_PORTABLE;
  if (!portable && method != draco::MESH_PREDICTION_TEX_COORDS_DEPRECATED) {
    return absl::OkStatus();
  }
  draco::DecoderBuffer ahead = buffer;
  std::uint32_t orientations = 0;
  bool read = SkipIntegers(ahead, entries, components);
  if (read) {
    read = portable || ahead.bitstream_version() < kVersion22
               ? ahead.Decode(&orientations)
               : draco::DecodeVarint(&orientations, &ahead);
  }
  if (read && orientations <= corners) return absl::OkStatus();
  return NotDraco(absl::StrCat(
      "the prediction of an attribute is damaged",
      read ? absl::StrCat(": ", orientations, " orientations for ", corners, " corners") : ""));
}

}  // namespace ccst::io
