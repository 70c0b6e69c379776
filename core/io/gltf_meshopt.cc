#include "core/io/gltf_meshopt.h"

#include <meshoptimizer.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/gltf_document.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"

namespace ccst::io {
namespace {

// A run of equal values costs meshoptimizer's densest mode one byte for 64 bytes that come out.
constexpr std::int64_t kMostExpansion = 256;
constexpr std::int64_t kSmallest = 1 << 16;

absl::Status Damaged() { return Unreadable("a buffer view compressed by meshopt is damaged"); }

bool Decode(const std::string& mode, std::size_t count, std::size_t stride,
            std::string_view encoded, std::string& out) {
  const auto* const bytes = reinterpret_cast<const unsigned char*>(encoded.data());
  if (mode == "ATTRIBUTES") {
    return meshopt_decodeVertexBuffer(out.data(), count, stride, bytes, encoded.size()) == 0;
  }
  if (mode == "TRIANGLES") {
    return meshopt_decodeIndexBuffer(out.data(), count, stride, bytes, encoded.size()) == 0;
  }
  return meshopt_decodeIndexSequence(out.data(), count, stride, bytes, encoded.size()) == 0;
}

// The strides are those that meshoptimizer asserts.
bool HasStride(const std::string& mode, const std::string& filter, std::int64_t stride) {
  if (mode != "ATTRIBUTES") return (stride == 2 || stride == 4) && filter == "NONE";
  if (stride < 4 || stride > 256 || stride % 4 != 0) return false;
  if (filter == "OCTAHEDRAL") return stride == 4 || stride == 8;
  if (filter == "QUATERNION") return stride == 8;
  return true;
}

}  // namespace

absl::StatusOr<std::string> DecodeMeshopt(const nlohmann::json& extension, std::string_view encoded,
                                          std::int64_t max_bytes) {
  CCST_ASSIGN_OR_RETURN(const std::int64_t count, GltfInteger(extension, "count", 0));
  CCST_ASSIGN_OR_RETURN(const std::int64_t stride, GltfInteger(extension, "byteStride", 0));
  const std::string mode = extension.value("mode", "");
  const std::string filter = extension.value("filter", "NONE");
  if (mode != "ATTRIBUTES" && mode != "TRIANGLES" && mode != "INDICES") {
    return Unreadable(absl::StrCat(kMeshoptExtension, ": mode ", Quoted(mode), " is not known"));
  }
  if (filter != "NONE" && filter != "OCTAHEDRAL" && filter != "QUATERNION" &&
      filter != "EXPONENTIAL") {
    return Unreadable(
        absl::StrCat(kMeshoptExtension, ": filter ", Quoted(filter), " is not known"));
  }
  if (!HasStride(mode, filter, stride) || (mode == "TRIANGLES" && count % 3 != 0)) {
    return Unreadable(absl::StrCat(kMeshoptExtension, ": ", count, " rows of ", stride,
                                   " bytes are none of mode ", mode, " with filter ", filter));
  }
  const auto size = static_cast<std::int64_t>(encoded.size());
  if (count > max_bytes / stride) {
    return OverLimit(absl::StrCat(kMeshoptExtension, ": ", count, " rows of ", stride,
                                  " bytes; at most ", max_bytes, " bytes are accepted"));
  }
  if (count * stride > kSmallest + size * kMostExpansion) return Damaged();
  std::string out(static_cast<std::size_t>(count * stride), '\0');
  const auto rows = static_cast<std::size_t>(count);
  const auto row = static_cast<std::size_t>(stride);
  if (rows > 0 && !Decode(mode, rows, row, encoded, out)) return Damaged();
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), rows, row);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), rows, row);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), rows, row);
  return out;
}

}  // namespace ccst::io
