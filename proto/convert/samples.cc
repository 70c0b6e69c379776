#include "proto/convert/samples.h"

#include <string>

#include "core/base/status.h"

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

}  // namespace

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
