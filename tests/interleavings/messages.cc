#include "tests/interleavings/messages.h"

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "proto/convert/names.h"

namespace ccst::interleavings {

std::string SpecKey(const v1::JobSpec& spec) {
  return spec.mesh() + " " + spec.options().ShortDebugString();
}

std::string SpecKey(const v1::SampleRequest& request) {
  v1::JobSpec spec;
  spec.set_mesh(request.has_inline_mesh() ? NameOfMesh(request.inline_mesh().data())
                                          : request.mesh_name());
  *spec.mutable_options() = request.options();
  return SpecKey(spec);
}

std::string NameOfMesh(const std::string& bytes) { return MeshName(Sha256Of(bytes)); }

std::string Text(const absl::Status& status) {
  std::string text = absl::StatusCodeToString(status.code());
  if (const auto reason = GetErrorReason(status)) text.append(" ").append(ErrorReasonName(*reason));
  return text.append(" \"").append(std::string(status.message())).append("\"");
}

}  // namespace ccst::interleavings
