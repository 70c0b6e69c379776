#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/mesh_limits.h"

namespace ccst::io {

/// Numbers of an accessor, all within the file's bytes.
struct GltfAccessor {
  const char* data = nullptr;
  std::int64_t count = 0;   ///< Rows.
  std::int64_t stride = 0;  ///< Bytes from row to row.
  int component_type = 0;   ///< One of gltf_constants.h.
  int components = 0;       ///< Of a row.
  bool normalized = false;
  std::shared_ptr<const std::string> storage = nullptr;  ///< Of `data`, where it is not the file.

  /// Component of a row; integers that say so as fractions.
  double At(std::int64_t row, int component) const;
};

/// A glTF 2.0 file: its JSON, and its buffers with every access checked. The JSON's values may be
/// of any type; who reads them must be ready for nlohmann::json::exception.
class GltfDocument {
 public:
  /// @param bytes   a .glb or .gltf file; must outlive the document
  /// @param folder  where buffers beside the file are looked for, in it or in folders below;
  ///                without one only those inside the file are read
  /// @errors INVALID_ARGUMENT  MESH_UNREADABLE | LIMIT_EXCEEDED
  static absl::StatusOr<GltfDocument> Open(std::string_view bytes,
                                           const std::optional<std::string>& folder,
                                           const MeshLimits& limits);

  const nlohmann::json& json() const { return json_; }

  /// The element of an array at the top, for example of `nodes`.
  absl::StatusOr<const nlohmann::json*> Element(const char* array, std::int64_t index) const;
  /// The bytes of a buffer view, decoded where meshoptimizer compressed them.
  absl::StatusOr<std::string_view> BufferView(std::int64_t index) const;
  /// The numbers of an accessor; zeros where it has no buffer view, and with the values of a sparse
  /// one in their places.
  absl::StatusOr<GltfAccessor> Accessor(std::int64_t index) const;

 private:
  absl::StatusOr<std::string_view> Buffer(const nlohmann::json& view, std::int64_t index) const;
  absl::Status LayOut(std::string_view bytes, std::int64_t offset, const std::string& where,
                      GltfAccessor& accessor) const;
  absl::Status PutSparse(const nlohmann::json& sparse, const std::string& where,
                         GltfAccessor& accessor) const;
  absl::Status ReadBuffers(const std::optional<std::string>& folder, const MeshLimits& limits);

  nlohmann::json json_;
  std::string_view binary_;           // The chunk of a .glb.
  std::vector<std::string> storage_;  // What was decoded or read; empty where `binary_` is meant.
  std::vector<bool> is_binary_;
  std::int64_t max_decoded_bytes_ = 0;
  // Buffer views that were decoded, by number; what they may still take together.
  mutable std::map<std::int64_t, std::string> decoded_;
  mutable std::int64_t decoded_left_ = 0;
};

/// The integer of a component type that stands for 1 where an accessor is normalized; 1 for floats.
double GltfFullScale(int component_type);

/// The whole number that `object` has under `key`, `missing` when it has none.
/// @errors MESH_UNREADABLE  not a number in [0, 2^53]
absl::StatusOr<std::int64_t> GltfInteger(const nlohmann::json& object, const char* key,
                                         std::int64_t missing);

}  // namespace ccst::io
