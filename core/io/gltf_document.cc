#include "core/io/gltf_document.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status.h"
#include "core/io/gltf_constants.h"
#include "core/io/gltf_meshopt.h"
#include "core/io/io_errors.h"
#include "core/io/numbers.h"
#include "core/io/whole_file.h"

namespace ccst::io {
namespace {

using Json = nlohmann::json;

struct Chunks {
  std::string_view json;
  std::string_view binary;
};

absl::StatusOr<Chunks> CutGlb(std::string_view bytes) {
  constexpr std::size_t kHeader = 12;
  const auto word = [bytes](std::size_t at) {
    return LoadBytes<std::uint32_t>(bytes.data() + at, std::endian::little);
  };
  if (bytes.size() < kHeader) return Unreadable("the GLB header is cut off");
  if (word(4) != 2) {
    return Unreadable(absl::StrCat("glTF version ", word(4), "; version 2 is known"));
  }
  Chunks chunks;
  std::size_t at = kHeader;
  while (bytes.size() - at >= 8) {
    const std::size_t size = word(at);
    const std::uint32_t type = word(at + 4);
    at += 8;
    if (size > bytes.size() - at) {
      return Unreadable(absl::StrCat("byte ", at, ": a chunk of ", size, " bytes, but only ",
                                     bytes.size() - at, " are left"));
    }
    if (type == gltf::kJsonChunk && chunks.json.empty()) chunks.json = bytes.substr(at, size);
    if (type == gltf::kBinChunk && chunks.binary.empty()) chunks.binary = bytes.substr(at, size);
    at += size;
  }
  if (chunks.json.empty()) return Unreadable("the GLB file has no JSON chunk");
  return chunks;
}

// Decodes %20 and its like.
std::string PercentDecoded(std::string_view uri) {
  std::string result;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool is_code = uri[i] == '%' && i + 2 < uri.size() && absl::ascii_isxdigit(uri[i + 1]) &&
                         absl::ascii_isxdigit(uri[i + 2]);
    if (!is_code) {
      result += uri[i];
      continue;
    }
    result += absl::HexStringToBytes(absl::string_view(uri.data() + i + 1, 2));
    i += 2;
  }
  return result;
}

// Whether a relative path leads to a file in the folder it starts from, or below.
bool StaysBelow(std::string_view path) {
  if (path.empty() || path.front() == '/' || path.back() == '/') return false;
  if (path.find_first_of(std::string_view("\\:\0", 3)) != std::string_view::npos) return false;
  const std::vector<absl::string_view> parts =
      absl::StrSplit(absl::string_view(path.data(), path.size()), '/');
  return std::find(parts.begin(), parts.end(), "..") == parts.end();
}

absl::StatusOr<std::string> ReadUri(const std::string& uri,
                                    const std::optional<std::string>& folder,
                                    std::int64_t max_bytes) {
  if (uri.starts_with("data:")) {
    constexpr std::string_view kMark = ";base64,";
    const std::size_t mark = uri.find(kMark);
    std::string data;
    if (mark == std::string::npos ||
        !absl::Base64Unescape(
            absl::string_view(uri.data() + mark + kMark.size(), uri.size() - mark - kMark.size()),
            &data)) {
      return Unreadable("a buffer's data URI is not base64");
    }
    return data;
  }
  const std::string name = PercentDecoded(uri);
  if (!StaysBelow(name)) {
    return Unreadable(absl::StrCat("buffer ", Quoted(name),
                                   ": only files in the mesh's folder or below it are read"));
  }
  if (!folder.has_value()) {
    return Unreadable(absl::StrCat("buffer ", Quoted(name), " is another file, but the mesh was ",
                                   "not read from a file; save it as .glb"));
  }
  return ReadWholeFile(absl::StrCat(folder->empty() ? "." : *folder, "/", name), max_bytes);
}

int ComponentBytes(std::int64_t type) {
  switch (type) {
    case gltf::kSignedByte:
    case gltf::kUnsignedByte:
      return 1;
    case gltf::kSignedShort:
    case gltf::kUnsignedShort:
      return 2;
    case gltf::kUnsignedInt:
    case gltf::kFloat:
      return 4;
    default:
      return 0;
  }
}

int ComponentCount(const std::string& type) {
  constexpr std::array<std::pair<std::string_view, int>, 4> kTypes = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}};
  for (const auto& [name, count] : kTypes) {
    if (name == type) return count;
  }
  return 0;
}

template <typename T>
double Load(const char* data, bool normalized) {
  const auto value = static_cast<double>(LoadBytes<T>(data, std::endian::little));
  if (!normalized) return value;
  return std::max(-1.0, value / static_cast<double>(std::numeric_limits<T>::max()));
}

}  // namespace

double GltfAccessor::At(std::int64_t row, int component) const {
  const char* const at =
      data + row * stride + std::int64_t{component} * ComponentBytes(component_type);
  switch (component_type) {
    case gltf::kSignedByte:
      return Load<std::int8_t>(at, normalized);
    case gltf::kUnsignedByte:
      return Load<std::uint8_t>(at, normalized);
    case gltf::kSignedShort:
      return Load<std::int16_t>(at, normalized);
    case gltf::kUnsignedShort:
      return Load<std::uint16_t>(at, normalized);
    case gltf::kUnsignedInt:
      return Load<std::uint32_t>(at, normalized);
    default:
      return LoadBytes<float>(at, std::endian::little);
  }
}

double GltfFullScale(int component_type) {
  switch (component_type) {
    case gltf::kSignedByte:
      return std::numeric_limits<std::int8_t>::max();
    case gltf::kUnsignedByte:
      return std::numeric_limits<std::uint8_t>::max();
    case gltf::kSignedShort:
      return std::numeric_limits<std::int16_t>::max();
    case gltf::kUnsignedShort:
      return std::numeric_limits<std::uint16_t>::max();
    case gltf::kUnsignedInt:
      return std::numeric_limits<std::uint32_t>::max();
    default:
      return 1.0;
  }
}

absl::StatusOr<std::int64_t> GltfInteger(const Json& object, const char* key,
                                         std::int64_t missing) {
  const auto found = object.find(key);
  if (found == object.end()) return missing;
  constexpr std::uint64_t kMax = std::uint64_t{1} << 53;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > kMax) {
    return Unreadable(absl::StrCat("'", key, "' must be a whole number of at least 0"));
  }
  return static_cast<std::int64_t>(found->get<std::uint64_t>());
}

absl::StatusOr<GltfDocument> GltfDocument::Open(std::string_view bytes,
                                                const std::optional<std::string>& folder,
                                                const MeshLimits& limits) {
  GltfDocument document;
  document.max_decoded_bytes_ = limits.max_decoded_bytes;
  document.decoded_left_ = limits.max_decoded_bytes;
  Chunks chunks{.json = bytes, .binary = {}};
  if (bytes.starts_with(gltf::kMagic)) {
    CCST_ASSIGN_OR_RETURN(chunks, CutGlb(bytes));
  }
  document.binary_ = chunks.binary;
  document.json_ = Json::parse(chunks.json.begin(), chunks.json.end());
  if (!document.json_.is_object() || !document.json_.contains("asset")) {
    return Unreadable("the JSON is no glTF: it has no 'asset'");
  }
  CCST_RETURN_IF_ERROR(document.ReadBuffers(folder, limits));
  return document;
}

absl::Status GltfDocument::ReadBuffers(const std::optional<std::string>& folder,
                                       const MeshLimits& limits) {
  const auto buffers = json_.find("buffers");
  if (buffers == json_.end()) return absl::OkStatus();
  std::int64_t left = limits.max_bytes;
  for (const Json& buffer : *buffers) {
    CCST_ASSIGN_OR_RETURN(const std::int64_t length, GltfInteger(buffer, "byteLength", 0));
    // Only the first buffer can be the chunk of the .glb; others without bytes are fallbacks of
    // what is compressed elsewhere.
    const bool is_binary = !buffer.contains("uri") && storage_.empty();
    const bool is_fallback = !buffer.contains("uri") && !is_binary;
    std::string data;
    if (!is_binary && !is_fallback) {
      CCST_ASSIGN_OR_RETURN(data, ReadUri(buffer["uri"].get<std::string>(), folder, left));
    }
    const std::size_t size = is_binary ? binary_.size() : data.size();
    if (static_cast<std::uint64_t>(length) > size && !is_fallback) {
      return Unreadable(absl::StrCat("buffer ", storage_.size(), " announces ", length,
                                     " bytes, but has ", size));
    }
    left -= static_cast<std::int64_t>(data.size());
    storage_.push_back(std::move(data));
    is_binary_.push_back(is_binary);
  }
  return absl::OkStatus();
}

absl::StatusOr<const Json*> GltfDocument::Element(const char* array, std::int64_t index) const {
  const auto found = json_.find(array);
  if (found == json_.end() || !found->is_array() || index < 0 ||
      static_cast<std::uint64_t>(index) >= found->size()) {
    return Unreadable(absl::StrCat("there is no ", index, " in '", array, "' (counted from 0)"));
  }
  return &(*found)[static_cast<std::size_t>(index)];
}

// The bytes of a buffer that `view`, a buffer view or an extension of one, cuts out.
absl::StatusOr<std::string_view> GltfDocument::Buffer(const Json& view, std::int64_t index) const {
  CCST_ASSIGN_OR_RETURN(const std::int64_t buffer, GltfInteger(view, "buffer", -1));
  CCST_ASSIGN_OR_RETURN(const std::int64_t offset, GltfInteger(view, "byteOffset", 0));
  CCST_ASSIGN_OR_RETURN(const std::int64_t length, GltfInteger(view, "byteLength", 0));
  CCST_RETURN_IF_ERROR(Element("buffers", buffer).status());
  const auto at = static_cast<std::size_t>(buffer);
  const std::string_view bytes = is_binary_[at] ? binary_ : std::string_view(storage_[at]);
  if (static_cast<std::uint64_t>(offset) > bytes.size() ||
      static_cast<std::uint64_t>(length) > bytes.size() - static_cast<std::size_t>(offset)) {
    return Unreadable(
        absl::StrCat("buffer view ", index, " ends behind its buffer of ", bytes.size(), " bytes"));
  }
  return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

absl::StatusOr<std::string_view> GltfDocument::BufferView(std::int64_t index) const {
  CCST_ASSIGN_OR_RETURN(const Json* const view, Element("bufferViews", index));
  const Json extensions = view->value("extensions", Json::object());
  const auto extension = extensions.find(kMeshoptExtension);
  if (extension == extensions.end()) return Buffer(*view, index);
  if (const auto known = decoded_.find(index); known != decoded_.end()) return known->second;
  CCST_ASSIGN_OR_RETURN(const std::string_view encoded, Buffer(*extension, index));
  CCST_ASSIGN_OR_RETURN(std::string bytes, DecodeMeshopt(*extension, encoded, decoded_left_));
  decoded_left_ -= static_cast<std::int64_t>(bytes.size());
  return decoded_.emplace(index, std::move(bytes)).first->second;
}

// Where the rows of `accessor`, whose type and count are known, lie in `bytes`.
absl::Status GltfDocument::LayOut(std::string_view bytes, std::int64_t offset,
                                  const std::string& where, GltfAccessor& accessor) const {
  const std::int64_t row =
      std::int64_t{ComponentBytes(accessor.component_type)} * accessor.components;
  const auto size = static_cast<std::int64_t>(bytes.size());
  // In this order nothing overflows.
  const bool fits = accessor.count > 0 && accessor.stride >= row && offset <= size - row &&
                    accessor.count - 1 <= (size - row - offset) / accessor.stride;
  if (!fits) {
    return Unreadable(absl::StrCat(where, ": ", accessor.count, " rows of ", row,
                                   " bytes do not fit its buffer view of ", size, " bytes"));
  }
  accessor.data = bytes.data() + offset;
  return absl::OkStatus();
}

absl::Status GltfDocument::PutSparse(const Json& sparse, const std::string& where,
                                     GltfAccessor& accessor) const {
  const std::int64_t row =
      std::int64_t{ComponentBytes(accessor.component_type)} * accessor.components;
  CCST_ASSIGN_OR_RETURN(const std::int64_t count, GltfInteger(sparse, "count", 0));
  const auto open = [&](const char* key, GltfAccessor& part) -> absl::Status {
    const Json object = sparse.value(key, Json::object());
    CCST_ASSIGN_OR_RETURN(const std::int64_t view, GltfInteger(object, "bufferView", -1));
    CCST_ASSIGN_OR_RETURN(const std::string_view bytes, BufferView(view));
    CCST_ASSIGN_OR_RETURN(const std::int64_t offset, GltfInteger(object, "byteOffset", 0));
    if (part.component_type == 0) {
      CCST_ASSIGN_OR_RETURN(const std::int64_t type, GltfInteger(object, "componentType", 0));
      part.component_type = static_cast<int>(type);
    }
    part.count = count;
    part.stride = std::int64_t{ComponentBytes(part.component_type)} * part.components;
    if (part.stride == 0) return Unreadable(where + ": sparse indices are of an unknown type");
    return LayOut(bytes, offset, where, part);
  };
  GltfAccessor indices{.components = 1};
  GltfAccessor values{.component_type = accessor.component_type, .components = accessor.components};
  CCST_RETURN_IF_ERROR(open("indices", indices));
  CCST_RETURN_IF_ERROR(open("values", values));
  if (accessor.count > max_decoded_bytes_ / row) {
    return OverLimit(absl::StrCat(where, ": ", accessor.count, " rows of ", row, " bytes; at most ",
                                  max_decoded_bytes_, " bytes are accepted"));
  }
  auto dense = std::make_shared<std::string>(static_cast<std::size_t>(accessor.count * row), '\0');
  for (std::int64_t i = 0; i < accessor.count && accessor.stride > 0; ++i) {
    std::copy_n(accessor.data + i * accessor.stride, row, dense->data() + i * row);
  }
  for (std::int64_t i = 0; i < count; ++i) {
    const double at = indices.At(i, 0);
    if (!(at >= 0) || at >= static_cast<double>(accessor.count)) {
      return Unreadable(
          absl::StrCat(where, ": a sparse value is for row ", at, " of ", accessor.count));
    }
    std::copy_n(values.data + i * values.stride, row,
                dense->data() + static_cast<std::int64_t>(at) * row);
  }
  accessor.data = dense->data();
  accessor.stride = row;
  accessor.storage = std::move(dense);
  return absl::OkStatus();
}

absl::StatusOr<GltfAccessor> GltfDocument::Accessor(std::int64_t index) const {
  CCST_ASSIGN_OR_RETURN(const Json* const json, Element("accessors", index));
  const std::string where = absl::StrCat("accessor ", index);
  CCST_ASSIGN_OR_RETURN(const std::int64_t view, GltfInteger(*json, "bufferView", -1));
  CCST_ASSIGN_OR_RETURN(const std::int64_t offset, GltfInteger(*json, "byteOffset", 0));
  CCST_ASSIGN_OR_RETURN(const std::int64_t type, GltfInteger(*json, "componentType", 0));
  GltfAccessor accessor;
  CCST_ASSIGN_OR_RETURN(accessor.count, GltfInteger(*json, "count", 0));
  accessor.component_type = static_cast<int>(type);
  accessor.components = ComponentCount(json->value("type", ""));
  accessor.normalized = json->value("normalized", false);
  const std::int64_t row = std::int64_t{ComponentBytes(type)} * accessor.components;
  if (row == 0) return Unreadable(where + " is of a type that is not known");
  if (view >= 0) {
    CCST_ASSIGN_OR_RETURN(const std::string_view bytes, BufferView(view));
    CCST_ASSIGN_OR_RETURN(const Json* const view_json, Element("bufferViews", view));
    CCST_ASSIGN_OR_RETURN(accessor.stride, GltfInteger(*view_json, "byteStride", row));
    CCST_RETURN_IF_ERROR(LayOut(bytes, offset, where, accessor));
  } else {
    // All rows are the same zeros; only the count has to be held against something.
    static constexpr std::array<char, 16> kZeros = {};
    if (accessor.count <= 0 || accessor.count > max_decoded_bytes_ / row) {
      return Unreadable(absl::StrCat(where, " has ", accessor.count, " rows and no buffer view"));
    }
    accessor.data = kZeros.data();
    accessor.stride = 0;
  }
  const auto sparse = json->find("sparse");
  if (sparse != json->end()) CCST_RETURN_IF_ERROR(PutSparse(*sparse, where, accessor));
  return accessor;
}

}  // namespace ccst::io
