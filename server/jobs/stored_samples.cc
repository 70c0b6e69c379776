#include "server/jobs/stored_samples.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/status.h"
#include "server/jobs/block_sums.h"

namespace ccst::server {
namespace {

static_assert(std::endian::native == std::endian::little, "the layout is the memory's");

constexpr std::string_view kMagic("ccst-stored-samples-2\0\0\0", 24);
// As it was once, without sums.
constexpr std::string_view kMagicWithoutSums("ccst-stored-samples-1\0\0\0", 24);
constexpr std::uint32_t kMaxAttributes = 64;
constexpr std::uint32_t kMaxNameBytes = 1024;
constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

// Gathers small values into large appends, and puts the sums of all of them at the end.
class Buffer {
 public:
  explicit Buffer(BlobWriter& writer) : writer_(writer) {}

  template <typename T>
  void Add(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    if (bytes_.size() >= kBufferBytes) Flush();
  }
  void Add(std::string_view bytes) { bytes_ += bytes; }

  absl::Status Finish() {
    Flush();
    if (status_.ok()) status_ = writer_.Append(sums_.Finish());
    return status_;
  }

 private:
  void Flush() {
    sums_.Add(bytes_);
    if (status_.ok()) status_ = writer_.Append(bytes_);
    bytes_.clear();
  }

  BlobWriter& writer_;
  BlockSums sums_;
  std::string bytes_;
  absl::Status status_;
};

absl::Status Damaged(const std::string& what) {
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   "stored samples are damaged: " + what);
}

// Reads one value after the other.
class Cursor {
 public:
  explicit Cursor(const Blob& blob) : blob_(blob) {}

  template <typename T>
  absl::Status Take(T& value) {
    return TakeBytes({reinterpret_cast<char*>(&value), sizeof value});
  }
  absl::Status TakeBytes(std::span<char> out) {
    const auto size = static_cast<std::int64_t>(out.size());
    if (offset_ + size > blob_.size_bytes()) return Damaged("the header is cut off");
    CCST_RETURN_IF_ERROR(blob_.Read(offset_, out));
    offset_ += size;
    return absl::OkStatus();
  }
  std::int64_t offset() const { return offset_; }

 private:
  const Blob& blob_;
  std::int64_t offset_ = 0;
};

}  // namespace

absl::Status WriteSamples(const SampleSet& samples, BlobWriter& writer) {
  Buffer out(writer);
  out.Add(kMagic);
  out.Add(static_cast<std::uint64_t>(samples.faces.size()));
  out.Add(static_cast<std::uint64_t>(samples.triangles.size()));
  out.Add(static_cast<std::uint32_t>(samples.attributes.size()));
  for (const Attribute& attribute : samples.attributes) {
    out.Add(static_cast<std::uint32_t>(attribute.kind));
    out.Add(static_cast<std::uint32_t>(attribute.components));
    out.Add(static_cast<std::uint32_t>(attribute.name.size()));
    out.Add(std::string_view(attribute.name));
  }
  for (const std::int32_t face : samples.faces) out.Add(face);
  for (const Eigen::Vector2d& barycentric : samples.barycentrics) {
    out.Add(barycentric.x());
    out.Add(barycentric.y());
  }
  for (const auto* const vectors : {&samples.positions, &samples.normals}) {
    for (const Eigen::Vector3d& vector : *vectors) {
      for (int axis = 0; axis < 3; ++axis) out.Add(static_cast<float>(vector[axis]));
    }
  }
  for (const Attribute& attribute : samples.attributes) {
    for (const float value : attribute.values) out.Add(value);
  }
  for (const Eigen::Vector3i& triangle : samples.triangles) {
    for (const int corner : triangle) out.Add(std::int32_t{corner});
  }
  return out.Finish();
}

absl::StatusOr<StoredSamples> StoredSamples::Open(std::shared_ptr<const Blob> blob) {
  StoredSamples stored;
  stored.blob_ = std::move(blob);
  Cursor cursor(*stored.blob_);
  std::string magic(kMagic.size(), '\0');
  CCST_RETURN_IF_ERROR(cursor.TakeBytes(magic));
  const bool has_sums = magic == kMagic;
  if (!has_sums && magic != kMagicWithoutSums) return Damaged("they do not begin as samples do");
  std::uint64_t samples = 0;
  std::uint64_t triangles = 0;
  std::uint32_t attribute_count = 0;
  CCST_RETURN_IF_ERROR(cursor.Take(samples));
  CCST_RETURN_IF_ERROR(cursor.Take(triangles));
  CCST_RETURN_IF_ERROR(cursor.Take(attribute_count));
  const auto size = static_cast<std::uint64_t>(stored.blob_->size_bytes());
  if (samples > size || triangles > size || attribute_count > kMaxAttributes) {
    return Damaged("they announce more than they hold");
  }
  stored.sample_count_ = static_cast<std::int64_t>(samples);
  stored.triangle_count_ = static_cast<std::int64_t>(triangles);
  for (std::uint32_t i = 0; i < attribute_count; ++i) {
    std::uint32_t kind = 0;
    std::uint32_t components = 0;
    std::uint32_t name_bytes = 0;
    CCST_RETURN_IF_ERROR(cursor.Take(kind));
    CCST_RETURN_IF_ERROR(cursor.Take(components));
    CCST_RETURN_IF_ERROR(cursor.Take(name_bytes));
    if (kind > static_cast<std::uint32_t>(AttributeKind::kLabel) || components < 1 ||
        components > 4 || name_bytes > kMaxNameBytes) {
      return Damaged("attribute " + std::to_string(i) + " is not one");
    }
    Attribute attribute;
    attribute.kind = static_cast<AttributeKind>(kind);
    attribute.components = static_cast<int>(components);
    attribute.name.resize(name_bytes);
    CCST_RETURN_IF_ERROR(cursor.TakeBytes(attribute.name));
    stored.attributes_.push_back(std::move(attribute));
  }
  Offsets& offsets = stored.offsets_;
  const std::int64_t n = stored.sample_count_;
  offsets.faces = cursor.offset();
  offsets.barycentrics = offsets.faces + 4 * n;
  offsets.positions = offsets.barycentrics + 16 * n;
  offsets.normals = offsets.positions + 12 * n;
  std::int64_t end = offsets.normals + 12 * n;
  for (const Attribute& attribute : stored.attributes_) {
    offsets.attributes.push_back(end);
    end += 4 * n * attribute.components;
  }
  offsets.triangles = end;
  offsets.end = end + 12 * stored.triangle_count_;
  const std::int64_t sums_bytes = has_sums ? BlockSums::SizeFor(offsets.end) : 0;
  if (offsets.end + sums_bytes != stored.blob_->size_bytes()) {
    return Damaged("they are not as long as they announce");
  }
  if (!has_sums) return stored;
  stored.sums_.resize(static_cast<std::size_t>(sums_bytes));
  CCST_RETURN_IF_ERROR(stored.blob_->Read(offsets.end, stored.sums_));
  // What was read so far was read before the sums were known.
  std::string header(static_cast<std::size_t>(offsets.faces), '\0');
  CCST_RETURN_IF_ERROR(stored.ReadBytes(0, header));
  return stored;
}

absl::Status StoredSamples::ReadBytes(std::int64_t offset, std::span<char> out) const {
  if (sums_.empty()) return blob_->Read(offset, out);
  absl::Status read = ReadChecked(*blob_, offsets_.end, sums_, offset, out);
  if (!absl::IsDataLoss(read)) return read;
  return Damaged(std::string(read.message()) + "; the same request again computes them anew");
}

template <typename T>
absl::StatusOr<std::vector<T>> StoredSamples::ReadRows(std::int64_t offset, std::int64_t start,
                                                       std::int64_t count, int columns) const {
  std::vector<T> rows(static_cast<std::size_t>(count * columns));
  const std::int64_t row_bytes = static_cast<std::int64_t>(sizeof(T)) * columns;
  CCST_RETURN_IF_ERROR(ReadBytes(offset + start * row_bytes,
                                 {reinterpret_cast<char*>(rows.data()), rows.size() * sizeof(T)}));
  return rows;
}

absl::StatusOr<SampleSet> StoredSamples::ReadSamples(std::int64_t start, std::int64_t count) const {
  SampleSet samples;
  CCST_ASSIGN_OR_RETURN(samples.faces, ReadRows<std::int32_t>(offsets_.faces, start, count, 1));
  std::vector<double> barycentrics;
  CCST_ASSIGN_OR_RETURN(barycentrics, ReadRows<double>(offsets_.barycentrics, start, count, 2));
  std::vector<float> positions;
  CCST_ASSIGN_OR_RETURN(positions, ReadRows<float>(offsets_.positions, start, count, 3));
  std::vector<float> normals;
  CCST_ASSIGN_OR_RETURN(normals, ReadRows<float>(offsets_.normals, start, count, 3));
  for (std::size_t i = 0; i < samples.faces.size(); ++i) {
    samples.barycentrics.emplace_back(barycentrics[2 * i], barycentrics[2 * i + 1]);
    samples.positions.emplace_back(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
    samples.normals.emplace_back(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
  }
  samples.attributes = attributes_;
  for (std::size_t i = 0; i < attributes_.size(); ++i) {
    CCST_ASSIGN_OR_RETURN(
        samples.attributes[i].values,
        ReadRows<float>(offsets_.attributes[i], start, count, attributes_[i].components));
  }
  return samples;
}

absl::StatusOr<SampleSet> StoredSamples::ReadTriangles(std::int64_t start,
                                                       std::int64_t count) const {
  std::vector<std::int32_t> corners;
  CCST_ASSIGN_OR_RETURN(corners, ReadRows<std::int32_t>(offsets_.triangles, start, count, 3));
  SampleSet triangles;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    triangles.triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
  }
  return triangles;
}

}  // namespace ccst::server
