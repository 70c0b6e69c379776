#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ccst/v1/job.pb.h"
#include "ccst/v1/mesh.pb.h"

namespace ccst::cli {

/// `succeeded` for STATE_SUCCEEDED, and so on; `unknown` for what this version does not know.
std::string StateName(v1::Job::State state);
/// The reverse; empty for other names.
std::optional<v1::Job::State> StateFromName(std::string_view name);

/// A table for people, a line each below a heading, ends in a line break.
std::string JobsText(const std::vector<v1::Job>& jobs);
std::string MeshesText(const std::vector<v1::Mesh>& meshes);

/// A JSON array of objects and a line end. Times are RFC 3339; what is not known is null.
std::string JobsJson(const std::vector<v1::Job>& jobs);
std::string MeshesJson(const std::vector<v1::Mesh>& meshes);

}  // namespace ccst::cli
