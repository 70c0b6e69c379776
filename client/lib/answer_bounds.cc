#include "client/lib/answer_bounds.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "client/lib/checked_outcome.h"
#include "core/base/status.h"
#include "core/mesh/attributes.h"
#include "proto/convert/samples.h"

namespace ccst {
namespace {

// A mesh of n vertices has 2 n triangles, and four more for every handle, of which samplings have
// far fewer than samples: each takes several to be one.
constexpr std::int64_t kMaxTrianglesPerSample = 8;
// 1 GiB. What a mesh of the largest size with some attributes needs.
constexpr std::int64_t kMaxAttributeValues = std::int64_t{1} << 28;
// What a record takes in memory beside its bytes, and a page beside its records.
constexpr std::int64_t kRecordOverhead = 512;

std::int64_t Count(const auto& values) { return static_cast<std::int64_t>(values.size()); }

std::int64_t ComponentsOf(const std::vector<Attribute>& attributes) {
  std::int64_t components = 0;
  for (const Attribute& attribute : attributes) components += attribute.components;
  return components;
}

// Names end up in the headers of files.
absl::Status CheckNames(const v1::SampleChunk& chunk) {
  std::vector<Attribute> named;
  for (const v1::SampleAttribute& attribute : chunk.attributes()) {
    named.push_back({.name = attribute.name()});
  }
  NameAttributes(named);
  for (int i = 0; i < chunk.attributes_size(); ++i) {
    if (named[static_cast<std::size_t>(i)].name != chunk.attributes(i).name()) {
      return BrokenAnswer(absl::StrCat("attribute ", i, " of the samples has no proper name"));
    }
  }
  return absl::OkStatus();
}

absl::Status MoreThan(std::int64_t most, const char* what) {
  return BrokenAnswer(absl::StrCat("more than the ", most, " ", what, " that there can be"));
}

}  // namespace

AnswerBounds BoundsOf(const SamplingOptions& options, const TriangleMesh& mesh) {
  const std::int64_t samples = options.sample_count;
  return {.samples = samples,
          .triangles = kMaxTrianglesPerSample * samples,
          .attribute_values = samples * ComponentsOf(mesh.attributes)};
}

absl::Status BoundsOf(const v1::Job& job, AnswerBounds& bounds) {
  const std::int64_t samples = job.result().sample_count();
  const std::int64_t triangles = job.result().sample_mesh_face_count();
  const std::int64_t asked = job.effective_options().sample_count();
  if (samples != asked || samples < 0 || samples > kMaxSampleCount) {
    return BrokenAnswer(absl::StrCat(samples, " samples announced, asked for ", asked));
  }
  if (triangles < 0 || triangles > kMaxTrianglesPerSample * samples) {
    return BrokenAnswer(
        absl::StrCat(triangles, " triangles announced, of only ", samples, " samples"));
  }
  bounds = {.samples = samples, .triangles = triangles, .attribute_values = kMaxAttributeValues};
  return absl::OkStatus();
}

absl::Status AppendWithin(const AnswerBounds& bounds, const v1::SampleChunk& chunk,
                          SampleSet& samples) {
  const std::int64_t total = Count(samples.faces) + chunk.face_indices_size();
  if (total > bounds.samples) return MoreThan(bounds.samples, "samples");
  std::int64_t values = Count(samples.faces) * ComponentsOf(samples.attributes);
  for (const v1::SampleAttribute& attribute : chunk.attributes()) values += attribute.values_size();
  if (values > bounds.attribute_values) {
    return MoreThan(bounds.attribute_values, "values of attributes");
  }
  if (samples.faces.empty() && chunk.attributes_size() <= static_cast<int>(kMaxAttributes)) {
    CCST_RETURN_IF_ERROR(CheckNames(chunk));
  }
  return AsDataLoss(AppendChunk(chunk, samples));
}

absl::Status AppendWithin(const AnswerBounds& bounds, const v1::SampleMeshChunk& chunk,
                          SampleSet& samples) {
  const std::int64_t total = Count(samples.triangles) + chunk.vertex_indices_size() / 3;
  if (total > bounds.triangles) return MoreThan(bounds.triangles, "triangles");
  return AsDataLoss(AppendChunk(chunk, samples));
}

absl::Status ListBounds::Take(int records, std::size_t bytes, const std::string& asked,
                              const std::string& next) {
  if (records > page_size_) {
    return BrokenAnswer(absl::StrCat("a page of ", records, " records, asked for ", page_size_));
  }
  if (!next.empty() && next == asked) return BrokenAnswer("a page of a list that leads to itself");
  left_ -= static_cast<std::int64_t>(bytes) + kRecordOverhead * (std::int64_t{records} + 1);
  if (left_ >= 0) return absl::OkStatus();
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kLimitExceeded,
                   "the server's list does not end within 256 MiB; ask for a part of it, for jobs "
                   "by state or label");
}

}  // namespace ccst
