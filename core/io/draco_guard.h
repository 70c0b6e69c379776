#pragma once

#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "core/io/draco_header.h"
#include "core/io/mesh_limits.h"
#include "draco/compression/attributes/mesh_attribute_indices_encoding_data.h"
#include "draco/compression/mesh/mesh_decoder.h"
#include "draco/core/decoder_buffer.h"
#include "draco/mesh/mesh.h"

namespace ccst::io {

/// Refuses a mesh whose attributes, as listed, would take more to decode than allowed, or than the
/// whole stream announced, for which memory is there. The header says nothing of attributes, and a
/// few bytes can announce hundreds of wide ones.
absl::Status CheckDracoAttributes(const draco::Mesh& mesh, std::size_t size,
                                  const MeshLimits& limits, std::int64_t announced_bytes);

/// Refuses the values of an attribute whose texture-coordinate prediction announces more
/// orientation bits than the mesh has corners: Draco decodes as many as 2^31 of them, half a
/// minute of work and 256 MiB, from a few bytes.
/// @param buffer   where the decoder stands: behind the prediction's method and transform
/// @param entries  values of the attribute, of `components` numbers each
/// @param corners  of the mesh
absl::Status CheckDracoOrientations(const draco::DecoderBuffer& buffer, std::size_t entries,
                                    int components, std::size_t corners);

/// Draco's `Decoder` for one method of meshes, stopped where the stream asks for more than its
/// size warrants. Only what happens once the header has been checked is guarded.
template <typename Decoder>
class GuardedDracoDecoder : public Decoder {
 public:
  /// @param announced_bytes  what decoding may take, from ReadDracoAnnouncement()
  GuardedDracoDecoder(std::size_t size, const MeshLimits& limits, std::int64_t announced_bytes)
      : size_(size), limits_(limits), announced_bytes_(announced_bytes) {}

  /// Why the stream was refused; OK when it was not. Not OK takes precedence over what Decode
  /// returned, which may then be success with wrong values.
  const absl::Status& refusal() const { return refusal_; }

  // Draco calls this when it is about to make the prediction for an attribute, the one point at
  // which its kind is known and its data not yet read.
  const draco::MeshAttributeIndicesEncodingData* GetAttributeEncodingData(
      int attribute) const override {
    const auto* const data = Decoder::GetAttributeEncodingData(attribute);
    if (data == nullptr) return nullptr;
    // The accessor for the buffer is not const, although reading does not change it here.
    const draco::DecoderBuffer& buffer = *const_cast<GuardedDracoDecoder*>(this)->buffer();
    refusal_.Update(
        CheckDracoOrientations(buffer, data->encoded_attribute_value_index_to_corner_map.size(),
                               this->point_cloud()->attribute(attribute)->num_components(),
                               3 * std::size_t{this->mesh()->num_faces()}));
    return refusal_.ok() ? data : nullptr;
  }

 protected:
  bool DecodeAllAttributes() override {
    refusal_.Update(CheckDracoAttributes(*this->mesh(), size_, limits_, announced_bytes_));
    return refusal_.ok() && Decoder::DecodeAllAttributes();
  }

 private:
  std::size_t size_;
  MeshLimits limits_;
  std::int64_t announced_bytes_;
  mutable absl::Status refusal_;
};

}  // namespace ccst::io
