#include "proto/convert/field_limits.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

// `jobs/` or `meshes/` and what follows, which is at most 64 bytes.
constexpr std::int64_t kName = 7 + 64;
constexpr std::int64_t kSha256 = 64;
// 128 characters of UTF-8, which the conversion counts.
constexpr std::int64_t kDisplayName = 4 * 128;
constexpr std::int64_t kText = 64;
constexpr std::int64_t kPageToken = 256;
constexpr std::int64_t kWarnings = 32;
constexpr std::int64_t kWarning = 1024;

constexpr auto kLimits = std::to_array<FieldLimit>({
    {"ccst.v1.AnalyzeJobRequest.name", kName},
    {"ccst.v1.AttributeDensity.attribute_name", kText},
    {"ccst.v1.CancelJobRequest.name", kName},
    {"ccst.v1.CreateJobRequest.display_name", kDisplayName},
    {"ccst.v1.CreateJobRequest.labels", kMaxLabels},
    {"ccst.v1.CreateJobRequest.LabelsEntry.key", kText},
    {"ccst.v1.CreateJobRequest.LabelsEntry.value", kText},
    {"ccst.v1.CreateJobRequest.request_id", kText},
    {"ccst.v1.CreateMeshRequest.data", 0, "max_inline_mesh_bytes"},
    {"ccst.v1.DeleteJobRequest.name", kName},
    {"ccst.v1.DeleteMeshRequest.name", kName},
    {"ccst.v1.Digest.sha256", kSha256},
    {"ccst.v1.DownloadMeshRequest.name", kName},
    {"ccst.v1.FindMissingMeshesRequest.digests", kMaxDigests},
    {"ccst.v1.GetJobRequest.name", kName},
    {"ccst.v1.GetMeshRequest.name", kName},
    {"ccst.v1.InlineMesh.data", 0, "max_inline_mesh_bytes"},
    {"ccst.v1.Job.display_name", kDisplayName},
    {"ccst.v1.Job.labels", kMaxLabels},
    {"ccst.v1.Job.LabelsEntry.key", kText},
    {"ccst.v1.Job.LabelsEntry.value", kText},
    {"ccst.v1.Job.mesh", kName},
    {"ccst.v1.Job.name", kName},
    {"ccst.v1.JobSpec.mesh", kName},
    {"ccst.v1.ListJobsRequest.labels", kMaxLabels},
    {"ccst.v1.ListJobsRequest.LabelsEntry.key", kText},
    {"ccst.v1.ListJobsRequest.LabelsEntry.value", kText},
    {"ccst.v1.ListJobsRequest.mesh", kName},
    {"ccst.v1.ListJobsRequest.page_token", kPageToken},
    {"ccst.v1.ListJobsRequest.states", 16},
    {"ccst.v1.ListMeshesRequest.page_token", kPageToken},
    {"ccst.v1.Mesh.attributes", 64},
    {"ccst.v1.Mesh.display_name", kDisplayName},
    {"ccst.v1.Mesh.name", kName},
    {"ccst.v1.Mesh.warnings", kWarnings, "", kWarning},
    {"ccst.v1.MeshAttribute.attribute_name", kText},
    {"ccst.v1.MeshChunk.data", 0, "max_chunk_bytes"},
    {"ccst.v1.MeshUploadHeader.display_name", kDisplayName},
    {"ccst.v1.ReadSampleMeshRequest.name", kName},
    {"ccst.v1.ReadSamplesRequest.name", kName},
    {"ccst.v1.SampleRequest.display_name", kDisplayName},
    {"ccst.v1.SampleRequest.labels", kMaxLabels},
    {"ccst.v1.SampleRequest.LabelsEntry.key", kText},
    {"ccst.v1.SampleRequest.LabelsEntry.value", kText},
    {"ccst.v1.SampleRequest.mesh_name", kName},
    {"ccst.v1.SamplingResult.warnings", kWarnings, "", kWarning},
    {"ccst.v1.Status.details", 8},
    {"ccst.v1.Status.message", static_cast<std::int64_t>(kMaxStatusMessageBytes)},
    {"ccst.v1.TextureDensity.image", 0, "max_texture_bytes"},
    {"ccst.v1.WatchJobRequest.name", kName},
    {"google.protobuf.Any.type_url", 128},
    {"google.protobuf.Any.value", 16 * 1024},
});

// No limit where nothing here says.
const FieldLimit& LimitOf(const FieldDescriptor& field) {
  static const FieldLimit kNone;
  static const auto* const kByField = [] {
    auto* const map = new std::map<std::string_view, const FieldLimit*>;
    for (const FieldLimit& limit : kLimits) map->emplace(limit.field, &limit);
    return map;
  }();
  const auto found = kByField->find(field.full_name());
  return found == kByField->end() ? kNone : *found->second;
}

std::vector<const FieldDescriptor*> SetFields(const Message& message) {
  std::vector<const FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  return fields;
}

bool IsText(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_STRING;
}

bool IsMessage(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
}

// Walks through a message, from the request's root on.
class Checker {
 public:
  explicit Checker(Violations& violations) : violations_(violations) {}

  void Check(const Message& message, const std::string& prefix) {
    for (const FieldDescriptor* const field : SetFields(message)) {
      const std::string path = prefix + field->name();
      if (field->is_repeated()) {
        CheckList(message, *field, path);
      } else {
        CheckOne(message, *field, path);
      }
    }
  }

 private:
  void CheckList(const Message& message, const FieldDescriptor& list, const std::string& path) {
    const Reflection& reflection = *message.GetReflection();
    const FieldLimit& limit = LimitOf(list);
    const int size = reflection.FieldSize(message, &list);
    CheckLength(size, limit.most, "entries", path);
    // What lies beyond the end need not be looked at as well.
    const int looked_at = static_cast<int>(limit.most > 0 ? std::min<std::int64_t>(size, limit.most)
                                                          : std::int64_t{size});
    for (int i = 0; i < looked_at; ++i) {
      const std::string entry_path = absl::StrCat(path, "[", i, "]");
      if (list.is_map()) {
        CheckEntry(reflection.GetRepeatedMessage(message, &list, i), path);
      } else if (IsMessage(list)) {
        Check(reflection.GetRepeatedMessage(message, &list, i), entry_path + ".");
      } else if (IsText(list)) {
        std::string scratch;
        const std::string& text =
            reflection.GetRepeatedStringReference(message, &list, i, &scratch);
        CheckLength(std::ssize(text), limit.most_each, "bytes", entry_path);
      }
    }
  }

  // Entries of a map have no number and go by the name of the map.
  void CheckEntry(const Message& entry, const std::string& path) {
    for (const FieldDescriptor* const field : SetFields(entry)) CheckOne(entry, *field, path);
  }

  void CheckOne(const Message& message, const FieldDescriptor& field, const std::string& path) {
    const Reflection& reflection = *message.GetReflection();
    if (IsMessage(field)) {
      Check(reflection.GetMessage(message, &field), path + ".");
    } else if (IsText(field)) {
      std::string scratch;
      const std::string& text = reflection.GetStringReference(message, &field, &scratch);
      const bool in_map = field.containing_type()->map_key() != nullptr;
      CheckLength(std::ssize(text), LimitOf(field).most,
                  in_map ? absl::StrCat("bytes in a ", field.name()) : "bytes", path);
    }
  }

  void CheckLength(std::int64_t length, std::int64_t most, const std::string& of_what,
                   const std::string& path) {
    if (most == 0 || length <= most) return;
    violations_.Add(path, absl::StrCat("has ", length, " ", of_what, ", must have at most ", most),
                    ErrorReason::kRequestInvalid);
  }

  Violations& violations_;
};

// Texts at a character, bytes anywhere.
std::string Cut(const FieldDescriptor& field, const std::string& text, std::int64_t most) {
  const auto size = static_cast<std::size_t>(most);
  return field.type() == FieldDescriptor::TYPE_STRING ? CutAtCharacter(text, size)
                                                      : text.substr(0, size);
}

void CutList(Message& message, const FieldDescriptor& list) {
  const Reflection& reflection = *message.GetReflection();
  if (list.is_map()) return;  // Keys that are cut could become one.
  const FieldLimit& limit = LimitOf(list);
  while (limit.most > 0 && reflection.FieldSize(message, &list) > limit.most) {
    reflection.RemoveLast(&message, &list);
  }
  for (int i = 0; i < reflection.FieldSize(message, &list); ++i) {
    if (IsMessage(list)) {
      CutToFieldLimits(*reflection.MutableRepeatedMessage(&message, &list, i));
    } else if (IsText(list) && limit.most_each > 0) {
      const std::string text = reflection.GetRepeatedString(message, &list, i);
      reflection.SetRepeatedString(&message, &list, i, Cut(list, text, limit.most_each));
    }
  }
}

}  // namespace

std::span<const FieldLimit> FieldLimits() { return kLimits; }

void CheckFieldLimits(const Message& request, Violations& violations) {
  Checker(violations).Check(request, "");
}

absl::Status CheckFieldLimits(const Message& request) {
  Violations violations;
  CheckFieldLimits(request, violations);
  return violations.ToStatus();
}

void CutToFieldLimits(Message& message) {
  const Reflection& reflection = *message.GetReflection();
  for (const FieldDescriptor* const field : SetFields(message)) {
    if (field->is_repeated()) {
      CutList(message, *field);
    } else if (IsMessage(*field)) {
      CutToFieldLimits(*reflection.MutableMessage(&message, field));
    } else if (const std::int64_t most = LimitOf(*field).most; IsText(*field) && most > 0) {
      std::string text = reflection.GetString(message, field);
      if (std::ssize(text) <= most) continue;
      reflection.SetString(&message, field, Cut(*field, text, most));
    }
  }
}

}  // namespace ccst
