#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "proto/convert/violations.h"

namespace ccst {

/// Longest `display_name` [characters].
inline constexpr std::int64_t kMaxDisplayName = 128;

/// Adds to `violations` under `path` when `text` has more than `longest` characters.
void CheckText(const std::string& text, std::int64_t longest, const std::string& path,
               Violations& violations);
/// Characters of UTF-8, which protobuf has checked.
std::int64_t CountCharacters(std::string_view text);

/// `meshes/{sha256}`.
std::string MeshName(std::string_view sha256);
/// The digest of a mesh's name; adds to `violations` under `path` when it is none.
std::string Sha256OfMeshName(const std::string& name, const std::string& path,
                             Violations& violations);

/// `jobs/{uuid}`.
std::string JobName(std::string_view id);
/// The id of a job's name; adds to `violations` under `path` when it is none.
std::string IdOfJobName(const std::string& name, const std::string& path, Violations& violations);

}  // namespace ccst
