#include "proto/convert/samples.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/mesh/attributes.h"
#include "proto/convert/enums.h"

namespace ccst {
namespace {

absl::Status BrokenStream(const std::string& message) {
  return MakeError(absl::StatusCode::kInternal, ErrorReason::kInternal,
                   "broken answer: " + message);
}

void AppendFloats(const Eigen::Vector3d& vector, google::protobuf::RepeatedField<float>& out) {
  for (int i = 0; i < 3; ++i) out.Add(static_cast<float>(vector[i]));
}

Eigen::Vector3d VectorAt(const google::protobuf::RepeatedField<float>& values, int row) {
  return Eigen::Vector3d(values[3 * row], values[3 * row + 1], values[3 * row + 2]);
}

v1::SampleAttribute AttributeToProto(const Attribute& attribute, std::int64_t start,
                                     std::int64_t count) {
  v1::SampleAttribute message;
  message.set_name(attribute.name);
  message.set_kind(ToProto(attribute.kind));
  message.set_component_count(attribute.components);
  const float* const values = attribute.values.data() + start * attribute.components;
  message.mutable_values()->Add(values, values + count * attribute.components);
  return message;
}

// A kind that is not known yet is a scalar to us.
AttributeKind KindOf(const v1::SampleAttribute& message) {
  return FromProto(message.kind()).value_or(AttributeKind::kScalar);
}

bool IsSame(const v1::SampleAttribute& message, const Attribute& attribute) {
  return message.name() == attribute.name && KindOf(message) == attribute.kind &&
         message.component_count() == attribute.components;
}

// Checks the attributes of a chunk of `count` samples that is to follow `samples`.
absl::Status CheckAttributes(const v1::SampleChunk& chunk, const SampleSet& samples) {
  constexpr int kMaxComponents = 4;
  const auto attributes = static_cast<std::size_t>(chunk.attributes_size());
  const bool is_first = samples.faces.empty();
  if (attributes > kMaxAttributes || (!is_first && attributes != samples.attributes.size())) {
    return BrokenStream("samples at " + std::to_string(chunk.start_index()) + " have " +
                        std::to_string(attributes) + " attributes");
  }
  for (std::size_t i = 0; i < attributes; ++i) {
    const v1::SampleAttribute& attribute = chunk.attributes(static_cast<int>(i));
    const bool fits =
        attribute.component_count() >= 1 && attribute.component_count() <= kMaxComponents &&
        attribute.name().size() <= kMaxAttributeName &&
        attribute.values_size() == attribute.component_count() * chunk.face_indices_size() &&
        (is_first || IsSame(attribute, samples.attributes[i]));
    if (fits) continue;
    return BrokenStream("attribute " + std::to_string(i) + " of the samples at " +
                        std::to_string(chunk.start_index()) + " does not fit them");
  }
  return absl::OkStatus();
}

void AppendAttributes(const v1::SampleChunk& chunk, SampleSet& samples) {
  if (samples.faces.empty()) {
    samples.attributes.clear();
    for (const v1::SampleAttribute& attribute : chunk.attributes()) {
      samples.attributes.push_back({.name = attribute.name(),
                                    .kind = KindOf(attribute),
                                    .components = attribute.component_count()});
    }
  }
  for (int i = 0; i < chunk.attributes_size(); ++i) {
    const auto& values = chunk.attributes(i).values();
    std::vector<float>& all = samples.attributes[static_cast<std::size_t>(i)].values;
    all.insert(all.end(), values.begin(), values.end());
  }
}

}  // namespace

std::int64_t SamplesPerChunk(std::span<const Attribute> attributes) {
  constexpr std::int64_t kHeaderBytes = std::int64_t{16} << 10;  // Names and lengths.
  // A face of at most five bytes, two doubles, six floats.
  std::int64_t sample_bytes = 5 + 2 * 8 + 6 * 4;
  for (const Attribute& attribute : attributes) {
    sample_bytes += 4 * std::int64_t{attribute.components};
  }
  return std::min(kMaxChunkLength, (kMaxChunkBytes - kHeaderBytes) / sample_bytes);
}

v1::SampleChunk SampleChunkToProto(const SampleSet& samples, std::int64_t start,
                                   std::int64_t count) {
  v1::SampleChunk chunk;
  chunk.set_start_index(start);
  const int reserved = static_cast<int>(count);
  chunk.mutable_face_indices()->Reserve(reserved);
  chunk.mutable_barycentrics()->Reserve(2 * reserved);
  chunk.mutable_positions()->Reserve(3 * reserved);
  chunk.mutable_normals()->Reserve(3 * reserved);
  for (auto i = static_cast<std::size_t>(start); i < static_cast<std::size_t>(start + count); ++i) {
    chunk.add_face_indices(samples.faces[i]);
    chunk.add_barycentrics(samples.barycentrics[i][0]);
    chunk.add_barycentrics(samples.barycentrics[i][1]);
    AppendFloats(samples.positions[i], *chunk.mutable_positions());
    AppendFloats(samples.normals[i], *chunk.mutable_normals());
  }
  for (const Attribute& attribute : samples.attributes) {
    *chunk.add_attributes() = AttributeToProto(attribute, start, count);
  }
  return chunk;
}

v1::SampleMeshChunk SampleMeshChunkToProto(const SampleSet& samples, std::int64_t start,
                                           std::int64_t count) {
  v1::SampleMeshChunk chunk;
  chunk.set_start_index(start);
  chunk.mutable_vertex_indices()->Reserve(static_cast<int>(3 * count));
  for (auto t = static_cast<std::size_t>(start); t < static_cast<std::size_t>(start + count); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      chunk.add_vertex_indices(samples.triangles[t][corner]);
    }
  }
  return chunk;
}

absl::Status AppendChunk(const v1::SampleChunk& chunk, SampleSet& samples) {
  if (chunk.start_index() != static_cast<std::int64_t>(samples.faces.size())) {
    return BrokenStream("samples start at " + std::to_string(chunk.start_index()) + ", " +
                        std::to_string(samples.faces.size()) + " came before");
  }
  const int count = chunk.face_indices_size();
  if (chunk.barycentrics_size() != 2 * count || chunk.positions_size() != 3 * count ||
      chunk.normals_size() != 3 * count) {
    return BrokenStream("arrays of the samples at " + std::to_string(chunk.start_index()) +
                        " do not fit each other");
  }
  CCST_RETURN_IF_ERROR(CheckAttributes(chunk, samples));
  AppendAttributes(chunk, samples);
  for (int i = 0; i < count; ++i) {
    samples.faces.push_back(chunk.face_indices(i));
    samples.barycentrics.emplace_back(chunk.barycentrics(2 * i), chunk.barycentrics(2 * i + 1));
    samples.positions.push_back(VectorAt(chunk.positions(), i));
    samples.normals.push_back(VectorAt(chunk.normals(), i));
  }
  return absl::OkStatus();
}

absl::Status AppendChunk(const v1::SampleMeshChunk& chunk, SampleSet& samples) {
  if (chunk.start_index() != static_cast<std::int64_t>(samples.triangles.size())) {
    return BrokenStream("triangles start at " + std::to_string(chunk.start_index()) + ", " +
                        std::to_string(samples.triangles.size()) + " came before");
  }
  if (chunk.vertex_indices_size() % 3 != 0) {
    return BrokenStream("a triangle has fewer than three corners");
  }
  const auto sample_count = static_cast<std::int64_t>(samples.faces.size());
  for (const std::int32_t index : chunk.vertex_indices()) {
    if (index < 0 || index >= sample_count) {
      return BrokenStream("a triangle names sample " + std::to_string(index) + " of " +
                          std::to_string(sample_count));
    }
  }
  for (int i = 0; i < chunk.vertex_indices_size(); i += 3) {
    samples.triangles.emplace_back(chunk.vertex_indices(i), chunk.vertex_indices(i + 1),
                                   chunk.vertex_indices(i + 2));
  }
  return absl::OkStatus();
}

}  // namespace ccst
